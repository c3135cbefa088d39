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

  LivelinessTimer();
  ~LivelinessTimer();
  LivelinessTimer(const LivelinessTimer&) = delete;
  LivelinessTimer& operator=(const LivelinessTimer&) = delete;

  /// From now until remove(); from any thread.
  void add(Commands& writer);
  void remove(Commands& writer);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Commands*> writers_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace aloft::agent_host
