#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "common/experiment/statistics.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report {

/// data/published.json, embedded in this program.
[[nodiscard]] const nlohmann::json& published();

/// Largest distance of the true value from the printed one: the published plus-minus, or half the last printed digit.
[[nodiscard]] double printed_tolerance(const nlohmann::json& published_value);

/// Compares an estimate with a value that is exact to +- tolerance. Agrees: the whole interval lies within, so that an
/// interval wider than the tolerance never agrees. Disagrees: the whole interval lies outside. An estimate without an
/// interval does not vary and counts as exact.
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
