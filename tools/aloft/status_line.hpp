#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace aloft::cli {

/// The last row of the terminal that standard error is: it never takes more than that row, and whatever else is printed
/// goes above it. Where standard error is no terminal, the same text is a plain line every few seconds. May be used by
/// several threads.
class StatusLine {
 public:
  /// The one of this process: there is only one last row.
  static StatusLine& of_process();

  /// What the row shows from now on; drawn at most a few times per second, or `now`.
  void show(std::string text, bool now = false);
  /// Lines that stay, above the row; without a row just lines.
  void print(std::string_view lines);
  /// The text shown last becomes a line that stays, and the row is free.
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

/// From now on what this process logs goes above the status line; a message that comes again and again is told once per
/// minute, with how often it was left out.
void log_above_status_line();

}  // namespace aloft::cli
