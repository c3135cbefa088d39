#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// Which agents of this worker are there, from what they say about themselves, and which were.
class AgentDirectory {
 public:
  struct Entry {
    wire::Privilege privilege = wire::PRIVILEGE_NONE;
    Clock::time_point seen;
    wire::AgentNews news;
    bool lost = false;
  };

  /// Returns true if the agent was not there before.
  bool update(const wire::AgentStatus& status, Clock::time_point now);
  /// Returns the names of those that have been silent for 3 s since the last call: they are lost until they speak
  /// again.
  std::vector<std::string> expire(Clock::time_point now);

  /// Null if the agent is not there.
  [[nodiscard]] const Entry* find(std::string_view agent) const;
  /// All of them, the lost ones too; at most as many as fit into a WorkerStatus.
  [[nodiscard]] std::vector<wire::AgentNews> news(Clock::time_point now) const;

 private:
  std::map<std::string, Entry, std::less<>> agents_;
};

}  // namespace aloft::channel
