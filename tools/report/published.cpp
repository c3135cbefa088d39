#include "tools/report/published.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "common/base/random.hpp"
#include "tools/report/embedded.hpp"
#include "tools/report/resampling.hpp"

namespace aloft::report {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

nlohmann::json with_interval(double value, experiment::Interval interval) {
  return {{"value", value}, {"ci95", {interval.low, interval.high}}};
}

double median_at(const std::vector<double>& values, std::span<const std::uint32_t> indices,
                 std::vector<double>& scratch) {
  scratch.clear();
  for (const std::uint32_t i : indices) scratch.push_back(values[i]);
  std::sort(scratch.begin(), scratch.end());
  return median_of_sorted(scratch);
}

/// The values of these agents over the trials that all of them have: one list per agent.
std::vector<std::vector<double>> common_trials(const std::vector<const AgentTrials*>& agents) {
  std::vector<std::vector<double>> values(agents.size());
  for (const std::uint32_t trial : agents.front()->trials) {
    std::vector<double> row;
    for (const AgentTrials* agent : agents) {
      const auto found = std::lower_bound(agent->trials.begin(), agent->trials.end(), trial);
      if (found != agent->trials.end() && *found == trial)
        row.push_back(agent->qos[static_cast<std::size_t>(found - agent->trials.begin())]);
    }
    if (row.size() != agents.size()) continue;
    for (std::size_t i = 0; i < row.size(); ++i) values[i].push_back(row[i]);
  }
  return values;
}

nlohmann::json ratio_of_medians(const nlohmann::json& published_value, const ConditionTrials& condition,
                                const AgentTrials& agent, std::uint64_t seed) {
  std::vector<const AgentTrials*> agents{&agent};
  for (const nlohmann::json& name : published_value.at("over")) {
    agents.push_back(condition.agent(name.get<std::string>()));
    if (agents.back() == nullptr) return nullptr;
  }
  const auto values = common_trials(agents);
  std::vector<double> scratch;
  const auto ratio = [&](std::span<const std::uint32_t> indices) {
    double others = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i) others += median_at(values[i], indices, scratch);
    return median_at(values[0], indices, scratch) * static_cast<double>(values.size() - 1) / others;
  };
  std::vector<std::uint32_t> every(values[0].size());
  if (every.empty()) return nullptr;
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<std::uint32_t>(i);
  return with_interval(ratio(every), resampled_ci95(every.size(), seed, ratio));
}

}  // namespace

const nlohmann::json& published() {
  static const nlohmann::json values = nlohmann::json::parse(embedded_published());
  return values;
}

bool belongs_to(const nlohmann::json& published_value, const ConditionTrials& condition) {
  if (published_value.contains("measured_flight")) {
    const std::string flight = lower(published_value["measured_flight"].get<std::string>());
    const auto names_it = [&](const std::string& name) { return lower(name).find(flight) != std::string::npos; };
    return condition.kind == experiment::WorldKind::measured &&
           (names_it(condition.name) || names_it(condition.experiment) || names_it(condition.measured_file));
  }
  return condition.kind == experiment::WorldKind::generated &&
         published_value.at("bs_density_per_km2").get<double>() == condition.bs_density_per_km2 &&
         published_value.at("building_density_per_km2").get<double>() == condition.building_density_per_km2;
}

double printed_tolerance(const nlohmann::json& published_value) {
  if (published_value.contains("plus_minus")) return published_value["plus_minus"].get<double>();
  const nlohmann::json& value = published_value.at("value");
  const std::string printed = value.dump();
  const std::size_t point = printed.find('.');
  if (value.is_number_integer() || point == std::string::npos) return 0.5;
  return 0.5 * std::pow(10.0, -static_cast<double>(printed.size() - point - 1));
}

nlohmann::json beside_published(const nlohmann::json& published_value, const ConditionTrials& condition) {
  const AgentTrials* agent = condition.agent(published_value.at("agent").get<std::string>());
  if (agent == nullptr) return nullptr;
  const auto statistic = published_value.at("statistic").get<std::string>();
  const std::uint64_t seed = name_hash("published " + statistic);
  if (statistic == "mean")
    return with_interval(experiment::mean(agent->qos), experiment::bootstrap_ci95(agent->qos, seed));
  if (statistic == "median")
    return with_interval(experiment::quantile(agent->qos, 0.5),
                         resampled_ci95(std::span<const double>(agent->qos), seed, median_of_sorted));
  if (statistic == "ratio of medians") return ratio_of_medians(published_value, condition, *agent, seed);
  throw std::logic_error("unknown published statistic: " + statistic);
}

}  // namespace aloft::report
