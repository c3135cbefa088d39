#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "tools/report/trials.hpp"

namespace aloft::report {

/// Every agent of these conditions once, in the order of display.
[[nodiscard]] std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions);

/// What the page knows of them: [{"name", "type", "learns", "privilege", "colour": {"light", "dark"}, "dash"}]. Agents
/// without a look of their own get one from a palette by their order, none that another agent here has while it lasts.
[[nodiscard]] nlohmann::json agent_list(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
