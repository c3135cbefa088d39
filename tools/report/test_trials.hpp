#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/radio/generated_world.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report::testing {

/// An agent with these values in trials 0, 1, ...; all of its 100 steps at 40 m, no height changes, 12.5 kJ, 3
/// handovers; all other metrics are 0.
inline AgentTrials agent(std::string name, std::string type, std::vector<double> qos) {
  AgentTrials result{std::move(name), std::move(type)};
  const agents::AgentSpec spec =
      agents::parse_agents(result.name.starts_with(result.type)
                               ? nlohmann::json(result.name)
                               : nlohmann::json{{"type", result.type}, {"name", result.name}},
                           "test")
          .front();
  result.privilege = spec.privilege();
  result.parameters = spec.parameters.to_json();
  result.qos = std::move(qos);
  for (std::size_t i = 0; i < result.qos.size(); ++i) result.trials.push_back(static_cast<std::uint32_t>(i));
  for (const flight::Metric& metric : flight::other_metrics())
    result.metrics[std::string(metric.key)].assign(result.qos.size(), 0.0);
  result.steps_at_m.assign(result.qos.size(), {{40.0, 100}});
  result.metrics["height_mean_m"].assign(result.qos.size(), 40.0);
  result.metrics["energy_j"].assign(result.qos.size(), 12.5);  // kJ, as shown
  result.metrics["handovers"].assign(result.qos.size(), 3.0);
  return result;
}

/// A generated world of the published preset.
inline ConditionTrials condition(double bs_density_per_km2, double building_density_per_km2,
                                 std::vector<AgentTrials> agents) {
  ConditionTrials result;
  result.experiment = "test";
  result.name = result.label = "a condition";
  result.bs_density_per_km2 = bs_density_per_km2;
  result.building_density_per_km2 = building_density_per_km2;
  result.world_parameters =
      radio::resolve_generated_world(
          {{"bs_density_per_km2", bs_density_per_km2}, {"building_density_per_km2", building_density_per_km2}}, "test")
          .to_json();
  result.agents = std::move(agents);
  for (const AgentTrials& a : result.agents)
    result.trials_expected = std::max(result.trials_expected, static_cast<std::uint32_t>(a.trials.size()));
  return result;
}

}  // namespace aloft::report::testing
