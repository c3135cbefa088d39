#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// Which agents of this worker are there, from what they say about themselves.
class AgentDirectory {
 public:
  struct Entry {
    wire::Privilege privilege = wire::PRIVILEGE_NONE;
    Clock::time_point seen;
  };

  /// Returns true if the agent was not there before.
  bool update(const wire::AgentStatus& status, Clock::time_point now);
  /// Forgets those that were silent for 3 s, and returns their names.
  std::vector<std::string> expire(Clock::time_point now);

  /// Null if the agent is not there.
  [[nodiscard]] const Entry* find(std::string_view agent) const;
  [[nodiscard]] std::vector<std::string> names() const;
  void clear() { agents_.clear(); }

 private:
  std::map<std::string, Entry, std::less<>> agents_;
};

}  // namespace aloft::channel
