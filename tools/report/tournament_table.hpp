#pragma once

#include <map>
#include <span>
#include <string>

#include "common/base/text_layout.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report {

/// CPU time of an agent per step, in microseconds, by its name.
using StepCosts = std::map<std::string, double, std::less<>>;

/// One line per agent with its gain over min-height in every condition (followed by half the width of the 95 %
/// interval, if trials differ), and means over the generated conditions: the share of the feasible head-room closed,
/// and the cost of a flight. Conditions over the same worlds share a column, even of different runs. Privileged agents
/// carry the mark of their tier. The best gain of each condition among agents without privilege is bold, if all of
/// them flew at least two trials there.
[[nodiscard]] TextTable tournament_overview(std::span<const ConditionTrials> conditions, const StepCosts& costs);

/// Markdown: a table per condition with everything that the overview leaves out.
[[nodiscard]] std::string tournament_details(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
