#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// Names the peers that the flights of a worker wait for: in every status, and in the log when they change. No bus; the
/// clock is passed in.
class MissingPeers {
 public:
  /// A peer that is silent for longer than this is missing.
  static constexpr std::chrono::seconds patience{3};

  /// What is known at one moment.
  struct Facts {
    std::map<std::string, Clock::duration> silent_agents{};  ///< asked, and silent for longer than `patience`
    std::vector<std::string> absent_agents{};                ///< not there, and waited for long enough
    Clock::duration collector_silence{};                     ///< while records are unconfirmed
    std::size_t records_unconfirmed = 0;
    bool environment_there = false;
  };

  explicit MissingPeers(Clock::time_point now) : environment_seen_(now) {}

  void update(const Facts& facts, Clock::time_point now);
  /// Empty if no peer is missing.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  Clock::time_point environment_seen_;
  std::string text_;
};

/// "agent dqn", "agents dqn, planner".
[[nodiscard]] std::string agents_text(const std::vector<std::string>& names);

}  // namespace aloft::channel
