#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/report/trials.hpp"

/// Finds the part of a run that the paper's numbers and claims are about: its own worlds, flights and agents.
namespace aloft::report {

/// Results of fewer trials are not compared with published values.
[[nodiscard]] std::size_t least_trials();

/// Why this condition is none of the paper's; empty if it is one: a generated world with the paper's settings and one
/// of its pairs of densities, or a measured flight with the SHA-256 of one of its flights.
[[nodiscard]] std::string why_not_the_papers(const ConditionTrials& condition);

/// Which of the paper's measured flights this is ("GCQ"), by the SHA-256 of its file; empty if none.
[[nodiscard]] std::string papers_flight(const ConditionTrials& condition);

/// An agent of the paper ("constant-120", "dqn") as it flew here, or why it cannot stand for it.
struct PapersAgent {
  const AgentTrials* trials = nullptr;  ///< null: it has not flown, or `why_not` says what differs
  std::string why_not{};                ///< another agent of that name or type, other parameters, too few trials
};

/// Finds an agent by type and parameters, whatever its name. Both members are empty if there is none.
[[nodiscard]] PapersAgent papers_agent(const ConditionTrials& condition, std::string_view name);

/// The paper's share of these conditions.
struct PapersShare {
  std::vector<ConditionTrials>
      conditions;                     ///< its worlds, each once; its agents alone, under the names it has for them
  std::vector<std::string> left_out;  ///< "label: reason", of all that looks like the paper's but is not
};
[[nodiscard]] PapersShare papers_share(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
