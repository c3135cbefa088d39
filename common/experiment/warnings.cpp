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

/// A difference between a world and the training worlds; equal differences of several worlds are merged.
struct Mismatch {
  std::string what;
  std::string expected;
  std::string value{};  ///< of a parameter that is not a number
  double least = 0.0;   ///< of a number, over all merged worlds
  double most = 0.0;

  [[nodiscard]] std::string text() const {
    const std::string range = least == most ? fmt::format("{:g}", least) : fmt::format("{:g} to {:g}", least, most);
    return fmt::format("{} {} instead of {}", what, value.empty() ? range : value, expected);
  }
  [[nodiscard]] bool same_but_for_its_number(const Mismatch& other) const {
    return what == other.what && value == other.value;
  }
};
using Mismatches = std::vector<Mismatch>;

void check_range(Mismatches& differences, std::string_view what, double value, double low, double high) {
  if (value < low || value > high)
    differences.push_back(
        {.what = std::string(what), .expected = fmt::format("{:g} to {:g}", low, high), .least = value, .most = value});
}

/// How a generated world differs from those of training.
Mismatches differences_of(const Parameters& world) {
  Mismatches differences;
  check_range(differences, "bs_density_per_km2", world.number("bs_density_per_km2"), made_for.bs_density_min_per_km2,
              made_for.bs_density_max_per_km2);
  check_range(differences, "building_density_per_km2", world.number("building_density_per_km2"),
              made_for.building_density_min_per_km2, made_for.building_density_max_per_km2);
  // height_resolution_m is not compared: a finer table matters only to agents that jump.
  static const std::vector<std::string> elsewhere{"bs_density_per_km2", "building_density_per_km2", "preset",
                                                  "height_resolution_m"};
  const Parameters published = radio::resolve_generated_world(nlohmann::json::object(), "");
  nlohmann::json here = world.to_json();
  nlohmann::json expected = published.to_json();
  here["propagation"] = world.text("propagation");
  expected["propagation"] = published.text("propagation");
  here["serving"] = world.text("serving");
  expected["serving"] = published.text("serving");
  here["spectral_efficiency_max"] = world.number("spectral_efficiency_max");
  expected["spectral_efficiency_max"] = published.number("spectral_efficiency_max");
  for (const auto& [key, value] : expected.items())  // another channel model has other parameters
    if (std::ranges::find(elsewhere, key) == elsewhere.end() && here.contains(key) && here.at(key) != value)
      differences.push_back({.what = key, .expected = value.dump(), .value = here.at(key).dump()});
  return differences;
}

Mismatches differences_of(const world::MeasuredFlight& flight) {
  Mismatches differences;
  check_range(differences, "heights", flight.heights, made_for.measured_levels_min, made_for.measured_levels_max);
  check_range(differences, "steps", flight.steps, made_for.measured_steps_min, made_for.measured_steps_max);
  return differences;
}

/// Conditions of one kind that share one warning.
struct Group {
  WorldKind kind = WorldKind::generated;
  Mismatches differences;
  std::vector<std::string> conditions;
};

void add(std::vector<Group>& groups, const Mismatches& differences, const Condition& condition) {
  const auto same = [&](const Group& group) {
    return group.kind == condition.kind &&
           std::ranges::equal(group.differences, differences,
                              [](const Mismatch& a, const Mismatch& b) { return a.same_but_for_its_number(b); });
  };
  auto group = std::ranges::find_if(groups, same);
  if (group == groups.end()) group = groups.insert(groups.end(), {condition.kind, differences, {}});
  group->conditions.push_back(condition.name);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    group->differences[i].least = std::min(group->differences[i].least, differences[i].least);
    group->differences[i].most = std::max(group->differences[i].most, differences[i].most);
  }
}

/// "condition 'a'", "conditions 'a', 'b', 'c' and 7 more".
std::string named(const std::vector<std::string>& conditions) {
  constexpr std::size_t shown = 3;
  std::vector<std::string> quoted;
  for (std::size_t i = 0; i < std::min(shown, conditions.size()); ++i) quoted.push_back("'" + conditions[i] + "'");
  return fmt::format("condition{} {}{}", conditions.size() == 1 ? "" : "s", fmt::join(quoted, ", "),
                     conditions.size() > shown ? fmt::format(" and {} more", conditions.size() - shown) : "");
}

/// Whether the agent flies by what generated worlds like those of training have shown: the prior that height-filter has
/// unless an experiment gives it another one. Over measured flights its unit is the mean reward, whatever their size.
bool is_fitted(const agents::AgentSpec& spec) {
  return spec.type == "height-filter" &&
         spec.parameters.to_json() == agents::parse_agents(spec.type, "").front().parameters.to_json();
}

/// Why an agent can do worse in conditions that differ from the training worlds; empty: it does not know them.
std::string_view reason_of(const agents::AgentSpec& spec, WorldKind kind) {
  if (agents::agent_type(spec.type).trained_beforehand) return "its model was not made for";
  return kind == WorldKind::generated && is_fitted(spec) ? "its prior was not fitted to" : "";
}

std::optional<world::MeasuredFlight> readable_flight(const Condition& condition) {
  if (condition.kind == WorldKind::generated) return std::nullopt;
  try {
    return read_measured_world(condition).flight;
  } catch (const InputError&) {
    return std::nullopt;  // a flight over it reports the error
  }
}

}  // namespace

std::vector<Warning> warnings(const Experiment& experiment) {
  std::vector<Group> untrained;
  std::vector<std::string> without_cells;
  std::vector<std::string> handed_over;
  for (const Condition& condition : experiment.conditions) {
    const std::optional<world::MeasuredFlight> flight = readable_flight(condition);
    Mismatches differences;
    if (condition.kind == WorldKind::generated) differences = differences_of(condition.world);
    if (flight) differences = differences_of(*flight);
    if (!differences.empty()) add(untrained, differences, condition);
    if (experiment.costs_in(condition).a3) handed_over.push_back(condition.name);
    if (flight && flight->serving_cell.empty()) without_cells.push_back(condition.name);
  }
  std::vector<Warning> found;
  for (const agents::AgentSpec& spec : experiment.agents) {
    for (const Group& group : untrained) {
      const std::string_view reason = reason_of(spec, group.kind);
      if (reason.empty()) continue;
      std::vector<std::string> texts;
      for (const Mismatch& difference : group.differences) texts.push_back(difference.text());
      found.push_back({spec.name, fmt::format("agent '{}': {} {}: {}; expect less of it there", spec.name, reason,
                                              named(group.conditions), fmt::join(texts, ", "))});
    }
  }
  if (!handed_over.empty())
    for (const agents::AgentSpec& spec : experiment.agents)
      if (agents::foresees(spec.privilege()))
        found.push_back({spec.name, fmt::format("agent '{}': it foresees the quality of the strongest cell, but in {} "
                                                "the cell that serves depends on the flight; others can do better",
                                                spec.name, named(handed_over))});
  const bool charged = experiment.costs.handover_cost > 0.0 || experiment.costs.handover_loss < 1.0;
  if (!without_cells.empty() && charged)
    found.push_back({"", fmt::format("{}: a measured flight without serving_cell, so handovers are never charged",
                                     named(without_cells))});
  return found;
}

}  // namespace aloft::experiment
