#include "services/runtime/standstill_watch.hpp"

#include <spdlog/spdlog.h>
#include <time.h>

#include <condition_variable>
#include <cstdlib>
#include <mutex>
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

void watch(const std::stop_token& stop, std::chrono::milliseconds limit, const StandstillWatch::React& react) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  const auto is_over = [&] { return stop.stop_requested(); };
  for (auto last = now(); !stopped.wait_for(lock, stop, limit / looks_per_limit, is_over);) {
    const auto still = now() - std::exchange(last, now());
    if (still >= limit - limit / looks_per_limit) react(still);  // it may have stopped at the end of a sleep
  }
}

}  // namespace

StandstillWatch::StandstillWatch(std::chrono::milliseconds limit, React react)
    : thread_([limit, react = std::move(react)](const std::stop_token& stop) { watch(stop, limit, react); }) {}

StandstillWatch::React end_to_be_started_again() {
  return [](std::chrono::milliseconds still) {
    spdlog::critical(
        "stood still for {} s: the other processes have forgotten this one and cannot accept it again; it ends, to be "
        "started again",
        still.count() / 1000);
    spdlog::default_logger()->flush();
    std::_Exit(exit_start_again);  // as if killed: what is in the air is flown again
  };
}

}  // namespace aloft::runtime
