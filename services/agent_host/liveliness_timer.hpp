#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "common/bus/endpoint.hpp"

namespace aloft::agent_host {

/// Proves ten times a second that this process lives, also while an agent thinks for long.
class LivelinessTimer {
 public:
  using Commands = bus::Writer<wire::HeightCommand>;

  /// From now until remove(); from any thread.
  void add(Commands& writer);
  void remove(Commands& writer);

 private:
  void work(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::vector<Commands*> writers_;
  std::jthread thread_{[this](const std::stop_token& stop) { work(stop); }};  // last: it uses what stands above
};

}  // namespace aloft::agent_host
