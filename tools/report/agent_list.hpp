#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "tools/report/trials.hpp"

namespace aloft::report {

/// Every agent of these conditions once, in the order of display.
[[nodiscard]] std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions);

/// All looks in their fixed order: those of registered agents, by rank, then the spare ones; 24 without plugins.
[[nodiscard]] std::vector<agents::Look> palette();

/// The agents as the page needs them: [{"name", "type", "learns", "privilege", "colour": {"light", "dark"}, "dash"}].
/// An agent without a look gets one of the palette that no registered agent has, by its name: the same in every report,
/// unless another agent of this one has it. With more agents than looks colours repeat, with other dashes.
[[nodiscard]] nlohmann::json agent_list(std::span<const ConditionTrials> conditions);

/// The tiers of knowledge, each after those that know less: [{"name", "mark", "sees", "shape": "full" | "half" |
/// "hollow"}].
[[nodiscard]] nlohmann::json tier_list();

}  // namespace aloft::report
