#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace aloft::cli {

/// The last row of the terminal on standard error. It never takes more than one row; other output goes above it. If
/// standard error is no terminal, the text is printed as a plain line every few seconds. Thread-safe.
class StatusLine {
 public:
  /// The only object of this class, because a terminal has one last row.
  static StatusLine& of_process();

  /// Sets the text of the row; drawn at most a few times per second, or `now`.
  void show(std::string text, bool now = false);
  /// Prints lines that stay above the row.
  void print(std::string_view lines);
  /// Turns the last text into a line that stays, and frees the row.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  StatusLine();
  void draw();

  const bool terminal_;
  std::mutex mutex_;
  std::string text_;
  Clock::time_point drawn_{};
};

/// From now on log messages appear above the status line; a repeated message is shown once per minute, with the number
/// of repetitions left out.
void log_above_status_line();

}  // namespace aloft::cli
