#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "tools/report/trials.hpp"

namespace aloft::report {

/// data/published.json, as it was when this program was built.
[[nodiscard]] const nlohmann::json& published();

/// Our value and its 95 % interval beside one published value, or null if this condition or its agents were not flown:
/// {"value", "ci95": [low, high]}. Statistics: "mean", "median", and "ratio of medians" (the agent's median over the
/// mean of the medians of `over`, on the same trials).
[[nodiscard]] nlohmann::json beside_published(const nlohmann::json& published_value, const ConditionTrials& condition);

/// How far the true value may be from the printed one: the published plus-minus, or half of the last printed digit.
[[nodiscard]] double printed_tolerance(const nlohmann::json& published_value);

/// True if the published value belongs to this condition: both densities are equal (generated), or the flight's name
/// stands in the name of the condition, experiment or file (measured). Presets that change the radio do not matter
/// here: the report says which condition it is.
[[nodiscard]] bool belongs_to(const nlohmann::json& published_value, const ConditionTrials& condition);

}  // namespace aloft::report
