#include "services/agent_host/liveliness_timer.hpp"

#include <chrono>

namespace aloft::agent_host {
namespace {

constexpr std::chrono::milliseconds period{100};

}  // namespace

void LivelinessTimer::add(Commands& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(&writer);
}

void LivelinessTimer::remove(Commands& writer) {
  const std::lock_guard lock(mutex_);
  std::erase(writers_, &writer);
}

void LivelinessTimer::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    for (Commands* writer : writers_) writer->assert_liveliness();
    stopped_.wait_for(lock, stop, period, [] { return false; });
  }
}

}  // namespace aloft::agent_host
