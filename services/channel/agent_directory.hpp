#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/bus/wire.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// What an agent is shown of the future. Our own: what its type declares; a foreign one: what it asks for. InputError
/// if the experiment does not allow it that much: its results would be marked as those of an agent that sees less.
[[nodiscard]] agents::Privilege granted(const agents::AgentSpec& spec, wire::Privilege asked_for);

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
  /// Returns the names of those that have been silent for 3 s since the last call, by their process: they are lost
  /// until they speak again.
  std::map<std::string, std::vector<std::string>> expire(Clock::time_point now);

  /// A flight needs this agent, which is not there.
  void miss(std::string_view agent, Clock::time_point now);
  /// Whether flights have waited long enough for this agent: 3 s after it was missed first, until it speaks again.
  [[nodiscard]] bool waited_long(std::string_view agent, Clock::time_point now) const;

  /// Null if the agent is not there.
  [[nodiscard]] const Entry* find(std::string_view agent) const;
  /// Of the agents that a flight of `spec` needs, those that are not there.
  [[nodiscard]] std::vector<std::string> absent(const agents::AgentSpec& spec) const;
  /// All of them, the lost ones too; at most as many as fit into a WorkerStatus.
  [[nodiscard]] std::vector<wire::AgentNews> news(Clock::time_point now) const;

 private:
  std::map<std::string, Entry, std::less<>> agents_;
  std::map<std::string, Clock::time_point, std::less<>> missed_;  // since when
};

}  // namespace aloft::channel
