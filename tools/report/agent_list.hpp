#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "tools/report/trials.hpp"

namespace aloft::report {

/// Every agent of these conditions once, in the order of display.
[[nodiscard]] std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions);

/// The agents as the page needs them: [{"name", "type", "learns", "privilege", "colour": {"light", "dark"}, "dash"}].
/// Agents without a look get the next free one of a palette, whose looks repeat once all are taken.
[[nodiscard]] nlohmann::json agent_list(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
