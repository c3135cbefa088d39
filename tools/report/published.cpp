#include "tools/report/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/base/json_text.hpp"
#include "common/base/random.hpp"
#include "tools/report/embedded.hpp"
#include "tools/report/paper.hpp"
#include "tools/report/resampling.hpp"

namespace aloft::report {
namespace {

double median_at(const std::vector<double>& values, std::span<const std::uint32_t> indices,
                 std::vector<double>& scratch) {
  scratch.clear();
  for (const std::uint32_t i : indices) scratch.push_back(values[i]);
  std::ranges::sort(scratch);
  return median_of_sorted(scratch);
}

/// The values of these agents over the trials that all of them have: one list per agent.
std::vector<std::vector<double>> common_trials(const std::vector<const AgentTrials*>& agents) {
  std::vector<std::vector<double>> values(agents.size());
  for (const std::uint32_t trial : agents.front()->trials) {
    std::vector<double> row;
    for (const AgentTrials* agent : agents) {
      const auto found = std::ranges::lower_bound(agent->trials, trial);
      if (found != agent->trials.end() && *found == trial)
        row.push_back(agent->qos[static_cast<std::size_t>(found - agent->trials.begin())]);
    }
    if (row.size() != agents.size()) continue;
    for (std::size_t i = 0; i < row.size(); ++i) values[i].push_back(row[i]);
  }
  return values;
}

struct Estimate {
  double value = 0.0;
  experiment::Interval interval;
  std::size_t trials = 0;
};

/// The median of the first over the mean of the medians of the others.
Estimate ratio_of_medians(const std::vector<const AgentTrials*>& agents, std::uint64_t seed) {
  const auto values = common_trials(agents);
  std::vector<double> scratch;
  const auto ratio = [&](std::span<const std::uint32_t> indices) {
    double others = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i) others += median_at(values[i], indices, scratch);
    return median_at(values[0], indices, scratch) * static_cast<double>(values.size() - 1) / others;
  };
  std::vector<std::uint32_t> every(values[0].size());
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<std::uint32_t>(i);
  return {ratio(every), resampled_ci95(every.size(), seed, ratio), every.size()};
}

Estimate estimate(const std::string& statistic, const std::vector<const AgentTrials*>& agents) {
  const std::uint64_t seed = name_hash("published " + statistic);
  const std::vector<double>& qos = agents.front()->qos;
  if (statistic == "mean") return {experiment::mean(qos), experiment::bootstrap_ci95(qos, seed), qos.size()};
  if (statistic == "median")
    return {experiment::quantile(qos, 0.5), resampled_ci95(std::span<const double>(qos), seed, median_of_sorted),
            qos.size()};
  if (statistic == "ratio of medians") return ratio_of_medians(agents, seed);
  throw std::logic_error("unknown published statistic: " + statistic);
}

nlohmann::json not_applicable(const std::string& reason) {
  return {
      {"verdict", "not-applicable"}, {"reason", reason}, {"value", nullptr}, {"ci95", nullptr}, {"trials", nullptr}};
}

const char* name_of(Agreement agreement) {
  constexpr std::array names{"agrees", "disagrees", "undecided"};
  return names.at(static_cast<std::size_t>(agreement));
}

/// Number of trials, to two digits, that would make the interval as narrow as the published value is exact.
double trials_needed(const Estimate& ours, double half_width, double tolerance) {
  const double needed = static_cast<double>(ours.trials) * std::pow(half_width / tolerance, 2.0);
  const double unit = std::pow(10.0, std::floor(std::log10(needed)) - 1.0);
  return std::ceil(needed / unit) * unit;
}

std::string why_undecided(const Estimate& ours, double tolerance) {
  const double half_width = (ours.interval.high - ours.interval.low) / 2.0;
  if (half_width <= tolerance) return fmt::format("the interval lies across the edge of ± {:g}", tolerance);
  return fmt::format("our interval is ± {:.2g}, the published value is good to ± {:g}; it takes about {:.0f} trials",
                     half_width, tolerance, trials_needed(ours, half_width, tolerance));
}

}  // namespace

const nlohmann::json& published() {
  static const nlohmann::json values = parse_json(embedded_published(), "the published values");
  return values;
}

double printed_tolerance(const nlohmann::json& published_value) {
  if (published_value.contains("plus_minus")) return published_value["plus_minus"].get<double>();
  const nlohmann::json& value = published_value.at("value");
  const std::string printed = value.dump();
  const std::size_t point = printed.find('.');
  if (value.is_number_integer() || point == std::string::npos) return 0.5;
  return 0.5 * std::pow(10.0, -static_cast<double>(printed.size() - point - 1));
}

Agreement agreement(double published, double tolerance, double ours, experiment::Interval interval) {
  const experiment::Interval here = interval.known() ? interval : experiment::Interval{ours, ours};
  const double low = published - tolerance;
  const double high = published + tolerance;
  if (here.low >= low && here.high <= high) return Agreement::agrees;
  return here.high < low || here.low > high ? Agreement::disagrees : Agreement::undecided;
}

bool belongs_to(const nlohmann::json& published_value, const ConditionTrials& condition) {
  if (published_value.contains("measured_flight"))
    return papers_flight(condition) == published_value["measured_flight"].get<std::string>();
  return condition.kind == experiment::WorldKind::generated &&
         published_value.at("bs_density_per_km2").get<double>() == condition.bs_density_per_km2 &&
         published_value.at("building_density_per_km2").get<double>() == condition.building_density_per_km2;
}

nlohmann::json beside_published(const nlohmann::json& published_value, const ConditionTrials& condition) {
  std::vector<std::string> names{published_value.at("agent").get<std::string>()};
  for (const nlohmann::json& other : published_value.value("over", nlohmann::json::array())) names.push_back(other);
  std::vector<const AgentTrials*> agents;
  for (const std::string& name : names) {
    const PapersAgent agent = papers_agent(condition, name);
    if (!agent.why_not.empty()) return not_applicable(agent.why_not);
    if (agent.trials == nullptr) return nullptr;
    agents.push_back(agent.trials);
  }
  const Estimate ours = estimate(published_value.at("statistic").get<std::string>(), agents);
  if (ours.trials < least_trials())
    return not_applicable(
        fmt::format("{} trials that all of these agents flew, at least {} are needed", ours.trials, least_trials()));
  const double tolerance = printed_tolerance(published_value);
  const Agreement verdict = agreement(published_value.at("value").get<double>(), tolerance, ours.value, ours.interval);
  nlohmann::json interval;
  if (ours.interval.known()) interval = {ours.interval.low, ours.interval.high};
  return {{"verdict", name_of(verdict)},
          {"reason", verdict == Agreement::undecided ? why_undecided(ours, tolerance) : ""},
          {"value", ours.value},
          {"ci95", std::move(interval)},
          {"trials", ours.trials}};
}

}  // namespace aloft::report
