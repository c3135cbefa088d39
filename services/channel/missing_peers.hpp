#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// Whom the flights of a worker wait for, in words, which the status repeats and the log says when others are missing
/// than before. No bus; the clock is passed in.
class MissingPeers {
 public:
  /// Who is silent for longer than this is missing.
  static constexpr std::chrono::seconds patience{3};

  /// What is known at one moment.
  struct Facts {
    std::map<std::string, Clock::duration> silent_agents{};  ///< that flights have asked, for longer than `patience`
    std::vector<std::string> absent_agents{};                ///< that flights have waited for long enough
    Clock::duration collector_silence{};                     ///< while records are unconfirmed
    std::size_t records_unconfirmed = 0;
    bool environment_there = false;
  };

  explicit MissingPeers(Clock::time_point now) : environment_seen_(now) {}

  void update(const Facts& facts, Clock::time_point now);
  /// Empty if nobody is missing.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  Clock::time_point environment_seen_;
  std::string text_;
};

/// "agent dqn", "agents dqn, planner".
[[nodiscard]] std::string agents_text(const std::vector<std::string>& names);

}  // namespace aloft::channel
