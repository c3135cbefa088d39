#include "tools/report/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/random.hpp"
#include "tools/report/resampling.hpp"

namespace aloft::report {
namespace {

using experiment::Interval;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Interval positive{0.0, infinity};
constexpr Interval negative{-infinity, 0.0};
/// "Hardly changes" in numbers.
constexpr Interval hardly{-0.1, 0.1};
/// "6 % to 41 %".
constexpr Interval published_gain{0.06, 0.41};

using Values = std::vector<double> AgentTrials::*;
using Conditions = std::span<const ConditionTrials>;
using Comparisons = std::vector<Comparison>;

bool is_paper_baseline(const AgentTrials& agent) {
  return agent.type == "min-height" || agent.type == "constant" || agent.type == "random-walk";
}

/// Agents of the paper that have flown here; `learner` is its reinforcement learner.
std::vector<const AgentTrials*> agents_where(const ConditionTrials& condition,
                                             const std::function<bool(const AgentTrials&)>& wanted) {
  std::vector<const AgentTrials*> found;
  for (const AgentTrials& agent : condition.agents)
    if (!agent.trials.empty() && wanted(agent)) found.push_back(&agent);
  return found;
}

std::uint64_t seed_of(const std::string& what) {
  return name_hash(what);
}

/// Mean difference a − b over the trials that both have.
Comparison difference(std::string what, std::string unit, const AgentTrials& a, const AgentTrials& b, Values values,
                      Interval claimed) {
  std::vector<double> differences;
  for (const auto& [i, k] : pairs(a, b)) differences.push_back((a.*values)[i] - (b.*values)[k]);
  Interval interval = experiment::bootstrap_ci95(differences, seed_of(what));
  if (!interval.known() && !differences.empty()) interval = {differences.front(), differences.front()};  // all the same
  return {std::move(what), std::move(unit), interval, claimed};
}

/// Mean of a over the mean of all b together, minus 1, over the trials that all have.
Comparison relative_gain(std::string what, const AgentTrials& a, const std::vector<const AgentTrials*>& b,
                         Interval claimed) {
  std::map<std::uint32_t, std::pair<double, std::vector<double>>> by_trial;
  for (std::size_t i = 0; i < a.trials.size(); ++i) by_trial[a.trials[i]].first = a.qos[i];
  for (const AgentTrials* agent : b)
    for (const auto& [i, k] : pairs(a, *agent)) by_trial[a.trials[i]].second.push_back(agent->qos[k]);
  std::vector<double> ours;
  std::vector<double> theirs;
  for (const auto& [trial, values] : by_trial) {
    if (values.second.size() != b.size()) continue;
    ours.push_back(values.first);
    theirs.push_back(experiment::mean(values.second));
  }
  const Interval interval = resampled_ci95(ours.size(), seed_of(what), [&](std::span<const std::uint32_t> indices) {
    double sum_ours = 0.0;
    double sum_theirs = 0.0;
    for (const std::uint32_t i : indices) {
      sum_ours += ours[i];
      sum_theirs += theirs[i];
    }
    return sum_ours / sum_theirs - 1.0;
  });
  return {std::move(what), "%", interval, claimed};
}

/// Conditions that differ in one density alone, by ascending density; each density once.
std::vector<std::vector<const ConditionTrials*>> sweeps(Conditions conditions, double ConditionTrials::*axis,
                                                        double ConditionTrials::*fixed) {
  std::map<std::pair<std::string, double>, std::map<double, const ConditionTrials*>> groups;
  for (const ConditionTrials& condition : conditions) {
    if (std::isnan(condition.*axis) || std::isnan(condition.*fixed)) continue;
    groups[{condition.other_parameters, condition.*fixed}].emplace(condition.*axis, &condition);
  }
  std::vector<std::vector<const ConditionTrials*>> result;
  for (const auto& [key, group] : groups) {
    if (group.size() < 2) continue;
    result.emplace_back();
    for (const auto& [density, condition] : group) result.back().push_back(condition);
  }
  return result;
}

/// Each generated world once, however many experiments flew it.
std::vector<const ConditionTrials*> distinct(Conditions conditions, bool generated_only) {
  std::vector<const ConditionTrials*> result;
  for (const ConditionTrials& condition : conditions) {
    const bool generated = condition.kind == experiment::WorldKind::generated;
    if (generated_only && !generated) continue;
    const bool seen = generated && std::any_of(result.begin(), result.end(), [&](const ConditionTrials* other) {
                        return other->seed == condition.seed && other->other_parameters == condition.other_parameters &&
                               other->bs_density_per_km2 == condition.bs_density_per_km2 &&
                               other->building_density_per_km2 == condition.building_density_per_km2;
                      });
    if (!seen) result.push_back(&condition);
  }
  return result;
}

std::string here(const ConditionTrials& condition) {
  return condition.experiment + ", " + condition.label;
}

Comparisons rl_improves(Conditions conditions, const std::string& learner) {
  Comparisons comparisons;
  for (const ConditionTrials* condition : distinct(conditions, false)) {
    const AgentTrials* rl = condition->agent(learner);
    const auto baselines = agents_where(*condition, is_paper_baseline);
    if (rl == nullptr || baselines.empty()) continue;
    for (const AgentTrials* baseline : baselines)
      comparisons.push_back(relative_gain(fmt::format("{}: {} over {}", here(*condition), learner, baseline->name), *rl,
                                          {baseline}, positive));
    comparisons.push_back(
        relative_gain(fmt::format("{}: {} over the average of the baselines", here(*condition), learner), *rl,
                      baselines, published_gain));
  }
  return comparisons;
}

Comparisons best_feasible(Conditions conditions, const std::string& learner) {
  Comparisons comparisons;
  for (const ConditionTrials* condition : distinct(conditions, true)) {
    const auto best =
        agents_where(*condition, [&](const AgentTrials& a) { return a.name == learner || a.type == "one-step-ahead"; });
    for (const AgentTrials* good : best)
      for (const AgentTrials* baseline : agents_where(*condition, is_paper_baseline))
        comparisons.push_back(difference(fmt::format("{}: {} − {}", here(*condition), good->name, baseline->name),
                                         condition->qos_unit(), *good, *baseline, &AgentTrials::qos, positive));
  }
  return comparisons;
}

/// For each agent `wanted`, each density against the next smaller one.
Comparisons along_bs_density(Conditions conditions, Values values, const char* unit, Interval claimed,
                             const std::function<bool(const AgentTrials&)>& wanted) {
  Comparisons comparisons;
  for (const auto& sweep :
       sweeps(conditions, &ConditionTrials::bs_density_per_km2, &ConditionTrials::building_density_per_km2))
    for (std::size_t i = 1; i < sweep.size(); ++i)
      for (const AgentTrials* dense : agents_where(*sweep[i], wanted))
        if (const AgentTrials* sparse = sweep[i - 1]->agent(dense->name))
          comparisons.push_back(
              difference(fmt::format("{}: {} at {} − at {} BS per km²", sweep[i]->experiment, dense->name,
                                     sweep[i]->bs_density_per_km2, sweep[i - 1]->bs_density_per_km2),
                         unit, *dense, *sparse, values, claimed));
  return comparisons;
}

Comparisons along_building_density(Conditions conditions, const std::function<bool(const AgentTrials&)>& wanted) {
  Comparisons comparisons;
  for (const auto& sweep :
       sweeps(conditions, &ConditionTrials::building_density_per_km2, &ConditionTrials::bs_density_per_km2))
    for (std::size_t i = 1; i < sweep.size(); ++i)
      for (const AgentTrials* dense : agents_where(*sweep[i], wanted))
        if (const AgentTrials* sparse = sweep[i - 1]->agent(dense->name))
          comparisons.push_back(
              relative_gain(fmt::format("{}: {} at {} over {} buildings per km²", sweep[i]->experiment, dense->name,
                                        sweep[i]->building_density_per_km2, sweep[i - 1]->building_density_per_km2),
                            *dense, {sparse}, hardly));
  return comparisons;
}

Comparisons fewer_changes(Conditions conditions, const std::string& learner) {
  Comparisons comparisons;
  for (const ConditionTrials* condition : distinct(conditions, false)) {
    const AgentTrials* rl = condition->agent(learner);
    const AgentTrials* ahead = condition->agent("one-step-ahead");
    if (rl == nullptr || ahead == nullptr) continue;
    comparisons.push_back(difference(fmt::format("{}: {} − one-step-ahead", here(*condition), learner),
                                     "changes per flight", *rl, *ahead, &AgentTrials::height_changes, negative));
  }
  return comparisons;
}

struct Reading {
  const char* id;
  const char* words;
  const char* needs;
  std::function<Comparisons(Conditions, const std::string& learner)> compare;
};

bool of_the_paper(const AgentTrials& agent, const std::string& learner) {
  return is_paper_baseline(agent) || agent.type == "one-step-ahead" || agent.type == "optimal-height" ||
         agent.name == learner;
}

const std::vector<Reading>& readings() {
  static const std::vector<Reading> all{
      {"rl-improves",
       "Read as: in every condition the learner's mean exceeds that of min-height, each constant height and the random "
       "walk, and their average by 6 % to 41 %.",
       "the dqn and at least one of the paper's baselines", rl_improves},
      {"best-feasible",
       "Read as: in every generated condition the learner and one-step-ahead have a larger mean than min-height, each "
       "constant height and the random walk, on the same worlds.",
       "generated worlds with the dqn or one-step-ahead, and one of the paper's baselines", best_feasible},
      {"density-lowers-qos",
       "Read as: the mean of each of the paper's agents falls from each base-station density to the next larger one.",
       "at least two base-station densities in otherwise equal worlds",
       [](Conditions conditions, const std::string& learner) {
         return along_bs_density(conditions, &AgentTrials::qos, "bit/s/Hz", negative,
                                 [&](const AgentTrials& a) { return of_the_paper(a, learner); });
       }},
      {"buildings-hardly-matter",
       "Read as: from each building density to the next larger one, the mean of each of the paper's agents (all fly at "
       "40 m or more, above nearly all buildings) changes by less than 10 %.",
       "at least two building densities in otherwise equal worlds",
       [](Conditions conditions, const std::string& learner) {
         return along_building_density(conditions, [&](const AgentTrials& a) { return of_the_paper(a, learner); });
       }},
      {"density-raises-height",
       "Read as: the mean height of one-step-ahead, optimal height and the learner grows from each base-station "
       "density to the next larger one.",
       "at least two base-station densities in otherwise equal worlds",
       [](Conditions conditions, const std::string& learner) {
         return along_bs_density(conditions, &AgentTrials::height_m, "m", positive, [&](const AgentTrials& a) {
           return of_the_paper(a, learner) && !is_paper_baseline(a);
         });
       }},
      {"fewer-height-changes",
       "Read as: in every condition the learner changes its height less often per flight than one-step-ahead.",
       "the dqn and one-step-ahead", fewer_changes},
  };
  return all;
}

bool inside(const Comparison& c) {
  return c.interval.low > c.claimed.low && c.interval.high < c.claimed.high;
}
bool outside(const Comparison& c) {
  return c.interval.high <= c.claimed.low || c.interval.low >= c.claimed.high;
}

std::string line(const Comparison& c) {
  const char* side = inside(c) ? "as claimed" : outside(c) ? "against the claim" : "open";
  if (c.unit == "%")
    return fmt::format("{}: {:+.1f} … {:+.1f} % ({})", c.what, 100 * c.interval.low, 100 * c.interval.high, side);
  return fmt::format("{}: {:+.2f} … {:+.2f} {} ({})", c.what, c.interval.low, c.interval.high, c.unit, side);
}

std::string reason(const Comparisons& comparisons, const char* needs) {
  if (comparisons.empty()) return fmt::format("There is nothing to compare: this needs {}.", needs);
  const auto for_it = std::count_if(comparisons.begin(), comparisons.end(), inside);
  const auto against = std::count_if(comparisons.begin(), comparisons.end(), outside);
  std::string text = fmt::format("{} of {} intervals lie where the claim says, {} wholly elsewhere.", for_it,
                                 comparisons.size(), against);
  if (against > 0)
    text += " Against it, first: " + line(*std::find_if(comparisons.begin(), comparisons.end(), outside)) + ".";
  return text;
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::supported:
      return "supported";
    case Verdict::contradicted:
      return "contradicted";
    case Verdict::undecided:
      return "undecided";
  }
  return "";
}

Verdict judge(std::span<const Comparison> comparisons) {
  if (std::any_of(comparisons.begin(), comparisons.end(), outside)) return Verdict::contradicted;
  return !comparisons.empty() && std::all_of(comparisons.begin(), comparisons.end(), inside) ? Verdict::supported
                                                                                             : Verdict::undecided;
}

std::vector<Claim> judge_claims(std::span<const ConditionTrials> conditions, const nlohmann::json& published_claims) {
  const std::string learner = published_learner(conditions);
  std::vector<Claim> claims;
  for (const nlohmann::json& published : published_claims) {
    const auto id = published.at("id").get<std::string>();
    const auto reading =
        std::find_if(readings().begin(), readings().end(), [&](const Reading& r) { return r.id == id; });
    if (reading == readings().end()) throw std::logic_error(fmt::format("no reading of the published claim '{}'", id));
    const Comparisons comparisons = reading->compare(conditions, learner);
    Claim claim{published.at("text").get<std::string>(),
                reading->words,
                judge(comparisons),
                reason(comparisons, reading->needs),
                {}};
    for (const Comparison& comparison : comparisons) claim.details.push_back(line(comparison));
    claims.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace aloft::report
