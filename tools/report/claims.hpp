#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/experiment/statistics.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report {

enum class Verdict : std::uint8_t { supported, contradicted, undecided, not_applicable };

[[nodiscard]] const char* verdict_name(Verdict verdict);

/// One measured quantity and the open range that a claim states for it.
struct Comparison {
  std::string what;  ///< "2.5 BS per km²: dqn − min-height"
  std::string unit;  ///< of the interval; "%": the values are shares
  experiment::Interval interval;
  experiment::Interval claimed;
  std::size_t pairs = 0;  ///< trials that the interval rests on
};

/// Supported: every interval lies inside what is claimed. Contradicted: at least one lies wholly outside. Otherwise
/// undecided; without a comparison, not applicable.
[[nodiscard]] Verdict judge(std::span<const Comparison> comparisons);

/// A published claim beside what the data say.
struct Claim {
  std::string text;     ///< as published
  std::string reading;  ///< what is compared, in words
  Verdict verdict = Verdict::undecided;
  std::string reason;
  std::vector<std::string> details;  ///< one line per comparison
};

/// Judges the claims of data/published.json ([{"id", "text", "sweep", "agents"}]) on what these conditions share with
/// the paper (paper.hpp): its worlds and flights, its agents, enough trials. A claim is supported only if all generated
/// worlds of its sweep and all agents that it names have flown.
/// std::logic_error if an id is unknown.
[[nodiscard]] std::vector<Claim> judge_claims(std::span<const ConditionTrials> conditions,
                                              const nlohmann::json& published_claims);

}  // namespace aloft::report
