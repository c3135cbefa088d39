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

/// How much of the future an agent is shown: an agent of ours what its type declares, a foreign agent what it asks for.
/// InputError if it asks for more than the experiment allows: its results would be marked with too low a privilege.
[[nodiscard]] agents::Privilege granted(const agents::AgentSpec& spec, wire::Privilege asked_for);

/// Which agents of this worker are there, from their status messages, and which are lost.
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
  /// Counts agents as lost that have sent no status for 3 s, until their next one. Returns the names of those lost
  /// since the last call, by process.
  std::map<std::string, std::vector<std::string>> expire(Clock::time_point now);

  /// Notes that a flight needs this agent, which is not there.
  void miss(std::string_view agent, Clock::time_point now);
  /// Whether flights have waited long enough for this agent: 3 s after the first miss(), until its next status.
  [[nodiscard]] bool waited_long(std::string_view agent, Clock::time_point now) const;

  /// Null if the agent is not there.
  [[nodiscard]] const Entry* find(std::string_view agent) const;
  /// The agents that a flight of `spec` needs and that are not there.
  [[nodiscard]] std::vector<std::string> absent(const agents::AgentSpec& spec) const;
  /// The latest status of every agent, lost ones included; at most as many as fit into a WorkerStatus.
  [[nodiscard]] std::vector<wire::AgentNews> news(Clock::time_point now) const;

 private:
  std::map<std::string, Entry, std::less<>> agents_;
  std::map<std::string, Clock::time_point, std::less<>> missed_;  // by agent: since when
};

}  // namespace aloft::channel
