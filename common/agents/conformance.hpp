#pragma once

#include <nlohmann/json_fwd.hpp>

namespace aloft::agents {

struct ConformanceOptions {
  bool lifelong = false;  ///< the agent declares that it keeps memory from flight to flight
  unsigned steps = 40;    ///< per flight; less for slow learners
};

/// What every agent must pass, as Catch2 checks: legal commands, at the height limits too; the same commands from the
/// same flight; a second flight like a fresh agent's; save and restore in mid-flight; damaged states refused; nothing
/// foreseen without the privilege; commands that depend on past reports alone; steps flown by someone else; both kinds
/// of quality. `entry` is an agent as in an experiment file.
void check_conformance(const nlohmann::json& entry, const ConformanceOptions& options = {});

}  // namespace aloft::agents
