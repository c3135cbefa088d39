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

  /// `message` names what the run waits for or the last error; empty if all is well. What is new in it stays as a line
  /// of its own; the same again, but for its numbers, does so once per minute.
  void update(std::uint64_t flights_done, unsigned workers_alive, unsigned workers_wanted, const std::string& message);
  /// There is no news, but time passes.
  void tick();
  /// A line of its own that stays, e.g. a restarted process.
  void note(const std::string& line);
  /// The last state, as a line that stays.
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
  std::map<std::string, Clock::time_point> told_;  ///< messages without their numbers
};

}  // namespace aloft::cli
