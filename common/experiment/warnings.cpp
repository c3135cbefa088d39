#include "common/experiment/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/agents/training_worlds.hpp"
#include "common/base/error.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/world.hpp"

namespace aloft::experiment {
namespace {

constexpr agents::TrainingWorlds made_for = agents::training_worlds;

void check_range(std::vector<std::string>& differences, std::string_view what, double value, double low, double high) {
  if (value < low || value > high)
    differences.push_back(fmt::format("{} {:g} instead of {:g} to {:g}", what, value, low, high));
}

/// How a generated world differs from those of training.
std::vector<std::string> differences_of(const Parameters& world) {
  std::vector<std::string> differences;
  check_range(differences, "bs_density_per_km2", world.number("bs_density_per_km2"), made_for.bs_density_min_per_km2,
              made_for.bs_density_max_per_km2);
  check_range(differences, "building_density_per_km2", world.number("building_density_per_km2"),
              made_for.building_density_min_per_km2, made_for.building_density_max_per_km2);
  // A finer table is for agents that jump.
  static const std::vector<std::string> elsewhere{"bs_density_per_km2", "building_density_per_km2", "preset",
                                                  "height_resolution_m"};
  const nlohmann::json here = world.to_json();
  const nlohmann::json published = radio::resolve_generated_world(nlohmann::json::object(), "").to_json();
  for (const auto& [key, value] : published.items())
    if (std::find(elsewhere.begin(), elsewhere.end(), key) == elsewhere.end() && here.at(key) != value)
      differences.push_back(fmt::format("{} {} instead of {}", key, here.at(key).dump(), value.dump()));
  return differences;
}

std::vector<std::string> differences_of(const world::MeasuredFlight& flight) {
  std::vector<std::string> differences;
  check_range(differences, "heights", flight.heights, made_for.measured_levels_min, made_for.measured_levels_max);
  check_range(differences, "steps", flight.steps, made_for.measured_steps_min, made_for.measured_steps_max);
  return differences;
}

std::optional<world::MeasuredFlight> readable_flight(const Condition& condition) {
  if (condition.kind == WorldKind::generated) return std::nullopt;
  try {
    return read_measured_flight(condition);
  } catch (const InputError&) {
    return std::nullopt;  // whoever flies it says so
  }
}

}  // namespace

std::vector<Warning> warnings(const Experiment& experiment) {
  std::vector<Warning> found;
  for (const Condition& condition : experiment.conditions) {
    const std::optional<world::MeasuredFlight> flight = readable_flight(condition);
    std::vector<std::string> differences;
    if (condition.kind == WorldKind::generated) differences = differences_of(condition.world);
    if (flight) differences = differences_of(*flight);
    for (const agents::AgentSpec& spec : experiment.agents)
      if (agents::agent_type(spec.type).trained_beforehand && !differences.empty())
        found.push_back(
            {spec.name, fmt::format("agent '{}': its model was not made for condition '{}': {}; expect less "
                                    "of it there",
                                    spec.name, condition.name, fmt::join(differences, ", "))});
    if (flight && flight->serving_cell.empty() && experiment.costs.handover_cost > 0.0)
      found.push_back({"", fmt::format("condition '{}': the measured flight has no serving_cell, so handover_cost is "
                                       "never charged there",
                                       condition.name)});
  }
  return found;
}

}  // namespace aloft::experiment
