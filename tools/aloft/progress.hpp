#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include "services/status/pace.hpp"

namespace aloft::cli {

/// The progress of a run, on the status line.
class Progress {
 public:
  Progress(std::uint64_t flights_total, std::uint64_t flights_already_done);

  /// `message` names what the run waits for or the last error; empty if all is well. A new message is also printed as a
  /// line that stays; one that differs from an earlier one in its numbers only, at most once per minute.
  void update(std::uint64_t flights_done, unsigned workers_alive, unsigned workers_wanted, const std::string& message);
  /// Redraws the line without a new status, because elapsed times change.
  void tick();
  /// Prints a line that stays, e.g. about a restarted process.
  void note(const std::string& line);
  /// Prints the last state as a line that stays.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string text(Clock::time_point now) const;
  void tell(const std::string& message, Clock::time_point now);

  std::uint64_t total_;
  std::uint64_t already_done_;
  std::uint64_t done_;
  std::string workers_;
  std::string message_;
  bool heard_ = false;
  status::Pace pace_;
  Clock::time_point started_ = Clock::now();
  std::map<std::string, Clock::time_point> told_;  ///< when each message, without its numbers, was printed
};

}  // namespace aloft::cli
