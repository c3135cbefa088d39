#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>

#include "common/experiment/statistics.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report {

/// data/published.json, as it was when this program was built.
[[nodiscard]] const nlohmann::json& published();

/// How far the true value may be from the printed one: the published plus-minus, or half of the last printed digit.
[[nodiscard]] double printed_tolerance(const nlohmann::json& published_value);

/// What an estimate says about a number that is good to +- tolerance. Agrees: its whole interval lies within; so no
/// interval agrees that is too wide to disagree. Disagrees: all of it lies outside. An estimate without an interval
/// varies with nothing, and counts as exact.
enum class Agreement : std::uint8_t { agrees, disagrees, undecided };
[[nodiscard]] Agreement agreement(double published, double tolerance, double ours, experiment::Interval interval);

/// True if the published value is of this condition's densities, or of this very measured flight.
[[nodiscard]] bool belongs_to(const nlohmann::json& published_value, const ConditionTrials& condition);

/// Our value beside one published value, for a condition of the paper that it belongs to: {"verdict": "agrees",
/// "disagrees", "undecided", "not-applicable"; "reason": why it is one of the last two, else ""; "value", "ci95": null
/// or [low, high]; "trials"}. Not applicable, without a value: an agent is not the paper's, or has too few trials. Null
/// if an agent has not flown. Statistics: "mean", "median", and "ratio of medians" (the agent's median over the mean
/// of the medians of `over`, on the same trials).
[[nodiscard]] nlohmann::json beside_published(const nlohmann::json& published_value, const ConditionTrials& condition);

}  // namespace aloft::report
