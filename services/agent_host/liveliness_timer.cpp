#include "services/agent_host/liveliness_timer.hpp"

#include <chrono>

namespace aloft::agent_host {
namespace {

constexpr std::chrono::milliseconds period{100};

}  // namespace

LivelinessTimer::LivelinessTimer() : thread_([this] { work(); }) {}

LivelinessTimer::~LivelinessTimer() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LivelinessTimer::add(Commands& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(&writer);
}

void LivelinessTimer::remove(Commands& writer) {
  const std::lock_guard lock(mutex_);
  std::erase(writers_, &writer);
}

void LivelinessTimer::work() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    for (Commands* writer : writers_) writer->assert_liveliness();
    changed_.wait_for(lock, period);
  }
}

}  // namespace aloft::agent_host
