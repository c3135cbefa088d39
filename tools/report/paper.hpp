#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/report/trials.hpp"

/// What of a run is the paper's own: its numbers and claims say nothing about other worlds, flights and agents.
namespace aloft::report {

/// Fewer trials are not compared with anything published.
[[nodiscard]] std::size_t least_trials();

/// Why this condition is none of the paper's; empty if it is one: a generated world with all of its settings and one of
/// its pairs of densities, or a measured flight with the SHA-256 of one of its flights.
[[nodiscard]] std::string why_not_the_papers(const ConditionTrials& condition);

/// Which of the paper's measured flights this is ("GCQ"), by the SHA-256 of its file; empty if none.
[[nodiscard]] std::string papers_flight(const ConditionTrials& condition);

/// An agent of the paper ("constant-120", "dqn") as it flew here, or why it cannot stand for it.
struct PapersAgent {
  const AgentTrials* trials = nullptr;  ///< null: it has not flown, or `why_not` says what speaks against it
  std::string why_not{};                ///< another agent of that name or type, other parameters, too few trials
};

/// Agents count by type and parameters, whatever their name. Nothing at all, if no such agent is in the condition.
[[nodiscard]] PapersAgent papers_agent(const ConditionTrials& condition, std::string_view name);

/// The paper's share of these conditions.
struct PapersShare {
  std::vector<ConditionTrials>
      conditions;                     ///< its worlds, each once; its agents alone, under the names it has for them
  std::vector<std::string> left_out;  ///< "label: reason", of all that looks like the paper's but is not
};
[[nodiscard]] PapersShare papers_share(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
