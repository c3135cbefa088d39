#include "tools/report/claims.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/random.hpp"
#include "tools/report/paper.hpp"
#include "tools/report/published.hpp"
#include "tools/report/resampling.hpp"

namespace aloft::report {
namespace {

using experiment::Interval;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Interval positive{0.0, infinity};
constexpr Interval negative{-infinity, 0.0};
/// The relative change that counts as "hardly changes".
constexpr Interval hardly{-0.1, 0.1};
/// The gain that the paper claims: 6 % to 41 %.
constexpr Interval published_gain{0.06, 0.41};
/// The paper's reinforcement learner.
constexpr const char* learner = "dqn";

using Values = const std::vector<double>& (*)(const AgentTrials&);
using Conditions = std::span<const ConditionTrials>;
using Comparisons = std::vector<Comparison>;

const std::vector<double>& qos(const AgentTrials& agent) {
  return agent.qos;
}
const std::vector<double>& mean_height(const AgentTrials& agent) {
  return agent.metrics.at("height_mean_m");
}
const std::vector<double>& height_changes(const AgentTrials& agent) {
  return agent.metrics.at("height_changes");
}

bool is_paper_baseline(const AgentTrials& agent) {
  return agent.type == "min-height" || agent.type == "constant" || agent.type == "random-walk";
}

bool any_agent(const AgentTrials& /*agent*/) {
  return true;
}

std::vector<const AgentTrials*> agents_where(const ConditionTrials& condition,
                                             const std::function<bool(const AgentTrials&)>& wanted) {
  std::vector<const AgentTrials*> found;
  for (const AgentTrials& agent : condition.agents)
    if (!agent.trials.empty() && wanted(agent)) found.push_back(&agent);
  return found;
}

/// Mean difference a − b over the trials that both have.
Comparison difference(std::string what, std::string unit, const AgentTrials& a, const AgentTrials& b, Values values,
                      Interval claimed) {
  std::vector<double> differences;
  for (const auto& [i, k] : pairs(a, b)) differences.push_back(values(a)[i] - values(b)[k]);
  Interval interval = experiment::bootstrap_ci95(differences, name_hash(what));
  if (!interval.known() && !differences.empty()) interval = {differences.front(), differences.front()};  // all the same
  return {std::move(what), std::move(unit), interval, claimed, differences.size()};
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
  const Interval interval = resampled_ci95(ours.size(), name_hash(what), [&](std::span<const std::uint32_t> indices) {
    double sum_ours = 0.0;
    double sum_theirs = 0.0;
    for (const std::uint32_t i : indices) {
      sum_ours += ours[i];
      sum_theirs += theirs[i];
    }
    return sum_ours / sum_theirs - 1.0;
  });
  return {std::move(what), "%", interval, claimed, ours.size()};
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

std::string here(const ConditionTrials& condition) {
  return condition.experiment + ", " + condition.label;
}

Comparisons rl_improves(Conditions conditions) {
  Comparisons comparisons;
  for (const ConditionTrials& condition : conditions) {
    const AgentTrials* rl = condition.agent(learner);
    const auto baselines = agents_where(condition, is_paper_baseline);
    if (rl == nullptr || baselines.empty()) continue;
    for (const AgentTrials* baseline : baselines)
      comparisons.push_back(relative_gain(fmt::format("{}: {} over {}", here(condition), learner, baseline->name), *rl,
                                          {baseline}, positive));
    comparisons.push_back(
        relative_gain(fmt::format("{}: {} over the average of the baselines", here(condition), learner), *rl, baselines,
                      published_gain));
  }
  return comparisons;
}

Comparisons best_feasible(Conditions conditions) {
  Comparisons comparisons;
  for (const ConditionTrials& condition : conditions) {
    if (condition.kind != experiment::WorldKind::generated) continue;
    const auto best =
        agents_where(condition, [&](const AgentTrials& a) { return a.name == learner || a.type == "one-step-ahead"; });
    for (const AgentTrials* good : best)
      for (const AgentTrials* baseline : agents_where(condition, is_paper_baseline))
        comparisons.push_back(difference(fmt::format("{}: {} − {}", here(condition), good->name, baseline->name),
                                         condition.qos_unit(), *good, *baseline, qos, positive));
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

Comparisons along_building_density(Conditions conditions) {
  Comparisons comparisons;
  for (const auto& sweep :
       sweeps(conditions, &ConditionTrials::building_density_per_km2, &ConditionTrials::bs_density_per_km2))
    for (std::size_t i = 1; i < sweep.size(); ++i)
      for (const AgentTrials* dense : agents_where(*sweep[i], any_agent))
        if (const AgentTrials* sparse = sweep[i - 1]->agent(dense->name))
          comparisons.push_back(
              relative_gain(fmt::format("{}: {} at {} over {} buildings per km²", sweep[i]->experiment, dense->name,
                                        sweep[i]->building_density_per_km2, sweep[i - 1]->building_density_per_km2),
                            *dense, {sparse}, hardly));
  return comparisons;
}

Comparisons fewer_changes(Conditions conditions) {
  Comparisons comparisons;
  for (const ConditionTrials& condition : conditions) {
    const AgentTrials* rl = condition.agent(learner);
    const AgentTrials* ahead = condition.agent("one-step-ahead");
    if (rl == nullptr || ahead == nullptr) continue;
    comparisons.push_back(difference(fmt::format("{}: {} − one-step-ahead", here(condition), learner),
                                     "changes per flight", *rl, *ahead, height_changes, negative));
  }
  return comparisons;
}

struct Reading {
  const char* id;
  const char* words;
  const char* needs;
  std::function<Comparisons(Conditions)> compare;
};

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
       [](Conditions conditions) { return along_bs_density(conditions, qos, "bit/s/Hz", negative, any_agent); }},
      {"buildings-hardly-matter",
       "Read as: from each building density to the next larger one, the mean of each of the paper's agents (all fly at "
       "40 m or more, above nearly all buildings) changes by less than 10 %.",
       "at least two building densities in otherwise equal worlds", along_building_density},
      {"density-raises-height",
       "Read as: the mean height of one-step-ahead, optimal height and the learner grows from each base-station "
       "density to the next larger one.",
       "at least two base-station densities in otherwise equal worlds",
       [](Conditions conditions) {
         return along_bs_density(conditions, mean_height, "m", positive,
                                 [](const AgentTrials& a) { return !is_paper_baseline(a); });
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

/// Agents and worlds of a claim that have not flown: "dqn at 1 / 200", base stations / buildings per km².
std::vector<std::string> missing(const nlohmann::json& claim, Conditions conditions) {
  std::vector<std::string> lines;
  for (const nlohmann::json& world : published().at("generated_worlds")) {
    const nlohmann::json& sweeps_of_world = world.at("sweeps");
    if (const nlohmann::json& sweep = claim.at("sweep");
        !sweep.is_null() && std::ranges::find(sweeps_of_world, sweep) == sweeps_of_world.end())
      continue;
    const auto flown = std::ranges::find_if(
        conditions, [&](const ConditionTrials& condition) { return belongs_to(world, condition); });
    std::vector<std::string> agents;
    for (const nlohmann::json& agent : claim.at("agents"))
      if (flown == conditions.end() || flown->agent(agent.get<std::string>()) == nullptr) agents.push_back(agent);
    if (!agents.empty())
      lines.push_back(fmt::format(
          "{} at {:g} / {:g}",
          agents.size() == claim["agents"].size() ? "all" : fmt::format("{}", fmt::join(agents, ", ")),
          world.at("bs_density_per_km2").get<double>(), world.at("building_density_per_km2").get<double>()));
  }
  return lines;
}

std::string why_not_applicable(const char* needs, const std::vector<std::string>& left_out) {
  constexpr std::size_t most = 4;
  std::string text = fmt::format("It needs {}; the paper's own, with at least {} trials.", needs, least_trials());
  if (left_out.empty()) return text;
  text += fmt::format(" Not counted: {}",
                      fmt::join(left_out.begin(),
                                left_out.begin() + static_cast<std::ptrdiff_t>(std::min(most, left_out.size())), "; "));
  return text + (left_out.size() > most ? fmt::format("; and {} more.", left_out.size() - most) : ".");
}

std::string reason(const Comparisons& comparisons, const std::vector<std::string>& missing) {
  const auto for_it = std::ranges::count_if(comparisons, inside);
  const auto against = std::ranges::count_if(comparisons, outside);
  std::string text = fmt::format("{} of {} intervals lie where the claim says, {} wholly elsewhere.", for_it,
                                 comparisons.size(), against);
  if (against > 0) text += " Against it, first: " + line(*std::ranges::find_if(comparisons, outside)) + ".";
  if (!missing.empty())
    text += fmt::format(" The claim also speaks of what has not flown here, base stations / buildings per km²: {}.",
                        fmt::join(missing, "; "));
  return text;
}

Claim judged(const nlohmann::json& published_claim, const Reading& reading, const PapersShare& share) {
  Claim claim{published_claim.at("text").get<std::string>(), reading.words, Verdict::not_applicable, {}, {}};
  Comparisons comparisons = reading.compare(share.conditions);
  std::erase_if(comparisons, [](const Comparison& c) { return c.pairs < least_trials(); });
  if (comparisons.empty()) {
    claim.reason = why_not_applicable(reading.needs, share.left_out);
    return claim;
  }
  const std::vector<std::string> lacking = missing(published_claim, share.conditions);
  claim.verdict = judge(comparisons);
  if (claim.verdict == Verdict::supported && !lacking.empty()) claim.verdict = Verdict::undecided;
  claim.reason = reason(comparisons, lacking);
  for (const Comparison& comparison : comparisons) claim.details.push_back(line(comparison));
  return claim;
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  constexpr std::array names{"supported", "contradicted", "undecided", "not-applicable"};
  return names.at(static_cast<std::size_t>(verdict));
}

Verdict judge(std::span<const Comparison> comparisons) {
  if (comparisons.empty()) return Verdict::not_applicable;
  if (std::ranges::any_of(comparisons, outside)) return Verdict::contradicted;
  return std::ranges::all_of(comparisons, inside) ? Verdict::supported : Verdict::undecided;
}

std::vector<Claim> judge_claims(std::span<const ConditionTrials> conditions, const nlohmann::json& published_claims) {
  const PapersShare share = papers_share(conditions);
  std::vector<Claim> claims;
  for (const nlohmann::json& claim : published_claims) {
    const auto id = claim.at("id").get<std::string>();
    const auto reading = std::ranges::find_if(readings(), [&](const Reading& r) { return r.id == id; });
    if (reading == readings().end()) throw std::logic_error(fmt::format("no reading of the published claim '{}'", id));
    claims.push_back(judged(claim, *reading, share));
  }
  return claims;
}

}  // namespace aloft::report
