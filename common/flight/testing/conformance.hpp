#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace aloft::agents {
struct AgentSpec;
}

namespace aloft::flight {

struct ConformanceOptions {
  bool lifelong = false;  ///< the agent declares that it keeps memory from flight to flight
  unsigned steps = 40;    ///< per flight; less for slow learners
};

/// Checks every promise of an agent: legal commands, at the height limits too; the same commands in the same flight; a
/// later flight like a fresh agent's, also after one that ended early; save and restore in mid-flight; damaged states
/// refused; nothing foreseen without the privilege; commands that depend on past reports alone; steps flown by another
/// agent; coming aboard in mid-flight; both kinds of quality; serving cells that depend on the flight. `entry` is an
/// agent as in an experiment file. Returns what is wrong and where to look, one sentence each; nothing if the agent
/// conforms.
[[nodiscard]] std::vector<std::string> conformance_problems(const nlohmann::json& entry,
                                                            const ConformanceOptions& options = {});
/// The same as Catch2 checks, in the library aloft_agent_conformance.
void check_conformance(const nlohmann::json& entry, const ConformanceOptions& options = {});

/// Whether the agent's commands change with qualities that the UAV does not measure, or that lie beyond the next step.
[[nodiscard]] bool depends_on_unmeasured(const agents::AgentSpec& spec, const ConformanceOptions& options = {});
[[nodiscard]] bool depends_beyond_next_step(const agents::AgentSpec& spec, const ConformanceOptions& options = {});

}  // namespace aloft::flight
