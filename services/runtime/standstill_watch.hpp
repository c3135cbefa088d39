#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace aloft::runtime {

/// Notices when this process has stood still: stopped by a signal, in a frozen container, or on a suspended machine.
class StandstillWatch {
 public:
  using React = std::function<void(std::chrono::milliseconds)>;

  /// Calls `react`, from a thread of its own, each time the process has not run for about `limit` or longer, with the
  /// time.
  StandstillWatch(std::chrono::milliseconds limit, React react);

 private:
  std::jthread thread_;
};

/// The exit code of a process without a fault that must be replaced by a new one; its supervisor starts that.
inline constexpr int exit_start_again = 75;

/// For a process that its peers have forgotten and cannot accept again (bus::longest_standstill): logs it and ends with
/// exit_start_again.
[[nodiscard]] StandstillWatch::React end_to_be_started_again();

}  // namespace aloft::runtime
