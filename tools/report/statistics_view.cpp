#include "tools/report/statistics_view.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/report/resampling.hpp"

namespace aloft::report {
namespace {

using experiment::Interval;
using nlohmann::json;

constexpr std::size_t profile_points = 81;

json as_json(Interval interval) {
  if (!interval.known()) return nullptr;
  return {rounded(interval.low), rounded(interval.high)};
}

/// Box plot after Tukey: whiskers reach to the last value within 1.5 box lengths, the rest are outliers.
void add_box(json& row, const std::vector<double>& sample) {
  const double q25 = experiment::quantile(sample, 0.25);
  const double q75 = experiment::quantile(sample, 0.75);
  const double low_fence = q25 - 1.5 * (q75 - q25);
  const double high_fence = q75 + 1.5 * (q75 - q25);
  double low = q25;
  double high = q75;
  json outliers = json::array();
  for (const double value : sample) {
    if (value < low_fence || value > high_fence) {
      outliers.push_back(rounded(value));
      continue;
    }
    low = std::min(low, value);
    high = std::max(high, value);
  }
  row["median"] = rounded(experiment::quantile(sample, 0.5));
  row["q25"] = rounded(q25);
  row["q75"] = rounded(q75);
  row["whiskers"] = {rounded(low), rounded(high)};
  row["outliers"] = std::move(outliers);
}

json gain_over(const AgentTrials& agent, const AgentTrials* reference, std::uint64_t seed) {
  if (reference == nullptr) return nullptr;
  std::vector<double> ours;
  std::vector<double> theirs;
  std::vector<double> differences;
  for (const auto& [i, k] : pairs(agent, *reference)) {
    ours.push_back(agent.qos[i]);
    theirs.push_back(reference->qos[k]);
    differences.push_back(agent.qos[i] - reference->qos[k]);
  }
  if (differences.empty()) return nullptr;
  return {{"pairs", differences.size()},
          {"mean", rounded(experiment::mean(differences))},
          {"ci95", as_json(experiment::bootstrap_ci95(differences, seed))},
          {"probability_of_improvement", rounded(experiment::probability_of_improvement(ours, theirs))}};
}

/// The gain as a share of the planner's, which is the best feasible flight, on the trials that the planner has flown;
/// null without a planner or without head-room.
json headroom_share(const json& gain, const ConditionTrials& condition) {
  const AgentTrials* planner = condition.agent("planner");
  if (gain.is_null() || planner == nullptr) return nullptr;
  const json best = gain_over(*planner, condition.agent("min-height"), condition.seed);
  if (best.is_null() || best["mean"].get<double>() <= 0.0) return nullptr;
  return rounded(gain["mean"].get<double>() / best["mean"].get<double>());
}

std::vector<double> profile_thresholds(const ConditionTrials& condition) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const AgentTrials& agent : condition.agents)
    for (const double qos : agent.qos) {
      low = std::min(low, qos);
      high = std::max(high, qos);
    }
  std::vector<double> thresholds(profile_points);
  for (std::size_t i = 0; i < profile_points; ++i) {
    const double share = static_cast<double>(i) / (profile_points - 1);
    thresholds[i] = std::floor(low) + share * (std::ceil(high) - std::floor(low));
  }
  return thresholds;
}

/// Agarwal et al., Deep Reinforcement Learning at the Edge of the Statistical Precipice, 2021, section 4.2.
json performance_profile(const std::vector<double>& sample, const std::vector<double>& thresholds) {
  json profile = json::array();
  for (const double threshold : thresholds) {
    const auto above = std::ranges::count_if(sample, [&](double value) { return value > threshold; });
    profile.push_back(rounded(static_cast<double>(above) / static_cast<double>(sample.size())));
  }
  return profile;
}

/// The histogram of the heights of all steps of all flights.
json heights_flown(const AgentTrials& agent) {
  std::map<double, std::uint32_t> steps_at_m;
  double steps = 0.0;
  for (const auto& flight : agent.steps_at_m)
    for (const auto& [height_m, count] : flight) {
      steps_at_m[height_m] += count;
      steps += count;
    }
  json heights{{"height_m", json::array()}, {"share", json::array()}};
  for (const auto& [height_m, count] : steps_at_m) {
    heights["height_m"].push_back(rounded(height_m));
    heights["share"].push_back(rounded(count / steps));
  }
  return heights;
}

json agent_row(const ConditionTrials& condition, const AgentTrials& agent, const std::vector<double>& thresholds) {
  json row{{"name", agent.name},
           {"privilege", agents::privilege_tier(agent.privilege).name},
           {"trials", agent.trials.size()},
           {"mean", rounded(experiment::mean(agent.qos))},
           {"ci95", as_json(experiment::bootstrap_ci95(agent.qos, condition.seed))},
           {"iqm", rounded(experiment::interquartile_mean(agent.qos))},
           {"iqm_ci95", as_json(resampled_ci95(std::span<const double>(agent.qos), condition.seed,
                                               experiment::interquartile_mean))},
           {"height_ci95_m", as_json(experiment::bootstrap_ci95(agent.metrics.at("height_mean_m"), condition.seed))},
           {"profile", performance_profile(agent.qos, thresholds)},
           {"heights", heights_flown(agent)},
           {"gain", gain_over(agent, condition.agent("min-height"), condition.seed)}};
  for (const flight::Metric& metric : flight::other_metrics())
    row["metrics"][std::string(metric.name)] = rounded(experiment::mean(agent.metrics.at(std::string(metric.key))));
  row["headroom_share"] = headroom_share(row["gain"], condition);
  add_box(row, agent.qos);
  return row;
}

}  // namespace

nlohmann::json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e4) / 1e4;
}

nlohmann::json significant(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 3.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

nlohmann::json statistics_view(const ConditionTrials& condition) {
  std::size_t trials = 0;
  for (const AgentTrials& agent : condition.agents) trials = std::max(trials, agent.trials.size());
  if (trials == 0) return nullptr;
  const std::vector<double> thresholds = profile_thresholds(condition);
  json view{{"trials", trials}, {"profile_thresholds", json::array()}, {"agents", json::array()}};
  for (const double threshold : thresholds) view["profile_thresholds"].push_back(rounded(threshold));
  for (const AgentTrials& agent : condition.agents)
    if (!agent.trials.empty()) view["agents"].push_back(agent_row(condition, agent, thresholds));
  return view;
}

}  // namespace aloft::report
