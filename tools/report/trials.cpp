#include "tools/report/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>

#include "common/experiment/statistics.hpp"
#include "common/world/site_map.hpp"

namespace aloft::report {
namespace {

using experiment::WorldKind;

bool is_of_map(const std::string& key) {
  return key.starts_with("site_map_");
}

std::string readable(const std::string& key, const nlohmann::json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (key == "bs_density_per_km2") return text + " BS per km²";
  if (key == "building_density_per_km2") return text + " buildings per km²";
  if (key == "site_map_error_m") return text + " m off";
  if (key == "site_map_missing") return fmt::format("{:g} % missing", 100.0 * value.get<double>());
  if (key == "site_map_route_points") return "next " + text + " points";
  return key + " " + text;
}

/// What is swept, in words: all of it, or all but the site map.
std::string label_of(const experiment::Condition& condition, const std::string& measured_file, bool with_map) {
  std::string label;
  for (const auto& [path, value] : condition.parameters.items()) {
    const std::string key = path.substr(path.rfind('.') + 1);
    if (with_map || !is_of_map(key)) label += (label.empty() ? "" : ", ") + readable(key, value);
  }
  if (!label.empty()) return label;
  if (!with_map && !condition.parameters.empty())  // only the map is swept: many maps of one place
    for (const char* key : {"bs_density_per_km2", "building_density_per_km2"})
      if (const nlohmann::json world = condition.world.to_json(); world.contains(key))
        label += (label.empty() ? "" : ", ") + readable(key, world[key]);
  if (!label.empty()) return label;
  return condition.name == "measured" && !measured_file.empty() ? "measured flight " + measured_file : condition.name;
}

/// How the site map differs from the exact one that tells the whole route; empty: not at all.
std::string map_of(const Parameters& world) {
  std::string text;
  for (const ParameterSpec& spec : world::site_map_parameters()) {
    const nlohmann::json value = world.to_json().value(spec.name, nlohmann::json(0));
    if (value != 0) text += (text.empty() ? "" : ", ") + readable(spec.name, value);
  }
  return text;
}

double take_number(nlohmann::json& parameters, const char* key) {
  const double value =
      parameters.contains(key) ? parameters[key].get<double>() : std::numeric_limits<double>::quiet_NaN();
  parameters.erase(key);
  return value;
}

ConditionTrials describe(const experiment::Experiment& experiment, const experiment::Condition& condition) {
  ConditionTrials trials;
  trials.experiment = experiment.name;
  trials.seed = experiment.seed;
  trials.name = condition.name;
  trials.kind = condition.kind;
  trials.trials_expected = experiment.trials;
  trials.costs = experiment.costs;
  trials.world_parameters = condition.world.to_json();
  nlohmann::json parameters = trials.world_parameters;
  trials.bs_density_per_km2 = take_number(parameters, "bs_density_per_km2");
  trials.building_density_per_km2 = take_number(parameters, "building_density_per_km2");
  trials.other_parameters = parameters.dump();
  if (condition.kind == WorldKind::measured)
    trials.measured_file = std::filesystem::path(parameters.value("file", "")).stem().string();
  trials.label = label_of(condition, trials.measured_file, true);
  trials.place = label_of(condition, trials.measured_file, false);
  trials.site_map = map_of(condition.world);
  for (const agents::AgentSpec& spec : experiment.agents)
    trials.agents.push_back({spec.name, spec.type, spec.privilege(), spec.parameters.to_json()});
  std::ranges::stable_sort(trials.agents, shown_before);
  return trials;
}

/// The steps of a flight by height. Only agents in generated worlds can be between two levels.
std::map<double, std::uint32_t> heights_of(const flight::FlightRecord& record, const experiment::Condition& condition) {
  std::map<double, std::uint32_t> steps_at_m;
  for (const flight::StepRecord& step : record.steps) {
    double height_m = step.height_m;
    if (condition.kind == WorldKind::generated) {
      const double lowest_m = condition.world.number("height_min_m");
      const double level_m = condition.world.number("height_step_m");
      height_m = lowest_m + level_m * std::round((height_m - lowest_m) / level_m);
    }
    ++steps_at_m[height_m];
  }
  return steps_at_m;
}

/// The entries of `from` at these indices.
AgentTrials at_indices(const AgentTrials& from, const std::vector<std::size_t>& indices) {
  AgentTrials some{from.name, from.type, from.privilege, from.parameters};
  for (const std::size_t i : indices) {
    some.trials.push_back(from.trials[i]);
    some.qos.push_back(from.qos[i]);
    some.steps_at_m.push_back(from.steps_at_m[i]);
    for (const auto& [key, values] : from.metrics) some.metrics[key].push_back(values[i]);
  }
  return some;
}

}  // namespace

std::string ConditionTrials::world() const {
  return fmt::format("seed {}, {} base stations and {} buildings per km2, {}", seed, bs_density_per_km2,
                     building_density_per_km2, other_parameters);
}

const AgentTrials* ConditionTrials::agent(std::string_view agent_name) const {
  const auto found = std::ranges::find_if(agents, [&](const AgentTrials& a) { return a.name == agent_name; });
  return found == agents.end() || found->trials.empty() ? nullptr : &*found;
}

const char* ConditionTrials::qos_name() const {
  return kind == WorldKind::measured ? "Throughput" : "Spectral efficiency";
}

std::string ConditionTrials::qos_unit() const {
  return std::string(flight::metrics()[flight::quality].unit_in(experiment::qos_kind(kind)).shown);
}

double qos_scale(WorldKind kind) {
  return kind == WorldKind::measured ? 1e-3 : 1.0;
}

std::string title_of_parameter(const std::string& key) {
  if (key == "bs_density_per_km2") return "Base stations per km²";
  if (key == "building_density_per_km2") return "Buildings per km²";
  if (key == "site_map_error_m") return "Error of the site map (m)";
  if (key == "site_map_missing") return "Share of the base stations that the site map lacks";
  if (key == "site_map_route_points") return "Points of the route told ahead";
  return key;
}

std::string title_of(const flight::Metric& metric) {
  std::string title(metric.name);
  title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
  return metric.unit.shown.empty() ? title : fmt::format("{} ({})", title, metric.unit.shown);
}

std::string heading_of(const flight::Metric& metric) {
  return std::string(metric.unit.shown.empty() ? metric.name : metric.heading);
}

bool shown_before(const AgentTrials& a, const AgentTrials& b) {
  return agents::agent_type(a.type).rank_of(a.name) < agents::agent_type(b.type).rank_of(b.name);
}

std::vector<ConditionTrials> without_flights(const experiment::Experiment& experiment) {
  std::vector<ConditionTrials> conditions;
  conditions.reserve(experiment.conditions.size());
  for (const experiment::Condition& condition : experiment.conditions)
    conditions.push_back(describe(experiment, condition));
  return conditions;
}

std::vector<ConditionTrials> read_trials(const store::ResultStore& results) {
  std::vector<ConditionTrials> conditions = without_flights(results.experiment());
  std::vector<std::map<std::string, AgentTrials*, std::less<>>> by_name(conditions.size());
  for (std::size_t i = 0; i < conditions.size(); ++i)
    for (AgentTrials& agent : conditions[i].agents) by_name[i][agent.name] = &agent;
  for (const store::FlightSummary& flight : results.flights()) {  // ascending trials per condition
    AgentTrials& agent = *by_name.at(flight.key.condition).at(flight.key.agent);
    const WorldKind kind = conditions[flight.key.condition].kind;
    agent.trials.push_back(flight.key.trial);
    agent.qos.push_back(flight.metrics.number(flight::quality) * qos_scale(kind));
    agent.steps_at_m.push_back(heights_of(store::decode_trace(results.trace(flight.key)),
                                          results.experiment().conditions.at(flight.key.condition)));
    for (std::size_t i = flight::quality + 1; i < flight::metrics().size(); ++i) {
      const flight::Metric& metric = flight::metrics()[i];
      agent.metrics[std::string(metric.key)].push_back(flight.metrics.number(i) /
                                                       metric.unit_in(experiment::qos_kind(kind)).stored_per_shown);
    }
  }
  return conditions;
}

std::vector<std::pair<std::size_t, std::size_t>> pairs(const AgentTrials& a, const AgentTrials& b) {
  return experiment::matches(a.trials, b.trials);
}

std::optional<ConditionTrials> selected(const ConditionTrials& all, std::string_view learner, std::string_view rival) {
  const AgentTrials* winner = all.agent(learner);
  const AgentTrials* loser = all.agent(rival);
  if (winner == nullptr || loser == nullptr) return std::nullopt;
  std::vector<std::uint32_t> kept;
  for (const auto& [i, k] : pairs(*winner, *loser))
    if (winner->qos[i] > loser->qos[k]) kept.push_back(winner->trials[i]);
  ConditionTrials result = all;
  for (AgentTrials& agent : result.agents) {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < agent.trials.size(); ++i)
      if (std::ranges::binary_search(kept, agent.trials[i])) indices.push_back(i);
    agent = at_indices(agent, indices);
  }
  return result;
}

std::string published_learner(std::span<const ConditionTrials> conditions) {
  std::string learner;
  for (const ConditionTrials& condition : conditions)
    for (const AgentTrials& agent : condition.agents) {
      if (agent.trials.empty() || agent.type != "dqn") continue;
      if (agent.name == "dqn") return agent.name;
      if (learner.empty()) learner = agent.name;
    }
  return learner;
}

}  // namespace aloft::report
