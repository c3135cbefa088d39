#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "common/bus/endpoint.hpp"

namespace aloft::agent_host {

/// Asserts the liveliness of its writers ten times a second, also while an agent computes for long.
class LivelinessTimer {
 public:
  using Commands = bus::Writer<wire::HeightCommand>;

  /// Asserts this writer until remove(). Both can be called from any thread.
  void add(Commands& writer);
  void remove(Commands& writer);

 private:
  void work(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::vector<Commands*> writers_;
  std::jthread thread_{[this](const std::stop_token& stop) { work(stop); }};  // last: it uses the members above
};

}  // namespace aloft::agent_host
