#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace aloft::cli {

/// The status line of a run, on standard error: redrawn in place on a terminal, a plain line every few seconds
/// otherwise.
class Progress {
 public:
  Progress(std::uint64_t flights_total, std::uint64_t flights_already_done);

  /// `message` names what the run waits for or the last error; empty if all is well.
  void update(std::uint64_t flights_done, unsigned workers_alive, unsigned workers_wanted, const std::string& message);
  /// A line of its own that stays, e.g. a restarted process.
  void note(const std::string& line);
  /// The last state, as a line that stays.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(bool force);
  void print(const std::string& line, std::string_view end) const;

  bool terminal_;
  std::uint64_t total_;
  std::uint64_t already_done_;
  Clock::time_point started_ = Clock::now();
  Clock::time_point drawn_;
  std::string text_;
  std::string last_message_;
};

}  // namespace aloft::cli
