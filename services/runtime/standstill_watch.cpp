#include "services/runtime/standstill_watch.hpp"

#include <spdlog/spdlog.h>
#include <time.h>

#include <cstdlib>
#include <utility>

namespace aloft::runtime {
namespace {

constexpr int looks_per_limit = 20;

/// Unlike the steady clock, this one goes on while the machine is suspended.
std::chrono::milliseconds now() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::seconds(time.tv_sec) +
                                                               std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace

StandstillWatch::StandstillWatch(std::chrono::milliseconds limit, React react)
    : thread_([this, limit, react = std::move(react)] { watch(limit, react); }) {}

StandstillWatch::~StandstillWatch() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void StandstillWatch::watch(std::chrono::milliseconds limit, const React& react) {
  std::unique_lock lock(mutex_);
  for (auto last = now(); !changed_.wait_for(lock, limit / looks_per_limit, [this] { return ending_; });) {
    const auto still = now() - std::exchange(last, now());
    if (still >= limit - limit / looks_per_limit) react(still);  // when it stopped, it had slept for a while already
  }
}

StandstillWatch::React end_to_be_started_again() {
  return [](std::chrono::milliseconds still) {
    spdlog::critical(
        "stood still for {} s: the others have forgotten this process and cannot take it in again; it ends, to be "
        "started again",
        still.count() / 1000);
    spdlog::default_logger()->flush();
    std::_Exit(exit_start_again);  // as if killed: what is in the air is flown again
  };
}

}  // namespace aloft::runtime
