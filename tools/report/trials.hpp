#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/store/result_store.hpp"

namespace aloft::report {

/// What one agent reached in the trials of one condition; index i of each list belongs to trials[i], ascending.
struct AgentTrials {
  std::string name;
  std::string type;
  agents::Privilege privilege = agents::Privilege::none;
  nlohmann::json parameters{};  ///< with every default filled in
  std::vector<std::uint32_t> trials{};
  std::vector<double> qos{};  ///< mean of the flight, in the condition's unit
  /// All other metrics by their keys, in the units that are shown; NaN: unknown.
  std::map<std::string, std::vector<double>, std::less<>> metrics{};
  /// How many steps were flown at each height, m; those between two levels of the world count for the nearest.
  std::vector<std::map<double, std::uint32_t>> steps_at_m{};
};

/// What the report knows about one condition.
struct ConditionTrials {
  std::string experiment;  ///< name
  std::uint64_t seed = 0;
  std::string name;
  std::string label;  ///< as shown: "2.5 BS per km², 25 m off"
  std::string place;  ///< the same without the site map: "2.5 BS per km²"
  std::string
      site_map;  ///< how it differs from the exact one that tells the whole route: "25 m off"; empty: not at all
  experiment::WorldKind kind = experiment::WorldKind::generated;
  double bs_density_per_km2 = 0.0;        ///< generated worlds; NaN if the world has none
  double building_density_per_km2 = 0.0;  ///< likewise
  nlohmann::json world_parameters;        ///< all of the world, with every default filled in
  std::string other_parameters;           ///< all but the two densities; conditions with equal texts are comparable
  flight::Costs costs;
  std::string measured_file;  ///< name of the file of a measured flight, without folder and ending
  std::uint32_t trials_expected = 0;
  std::vector<AgentTrials> agents;  ///< in the order of display

  /// The same text for conditions whose trials fly over the same worlds.
  [[nodiscard]] std::string world() const;
  [[nodiscard]] const AgentTrials* agent(std::string_view agent_name) const;
  [[nodiscard]] const char* qos_name() const;
  [[nodiscard]] std::string qos_unit() const;  ///< bit/s/Hz or Mbit/s
};

/// Measured throughput is stored in kbit/s and shown in Mbit/s.
[[nodiscard]] double qos_scale(experiment::WorldKind kind);

/// The conditions of an experiment and its agents, without a flight.
[[nodiscard]] std::vector<ConditionTrials> without_flights(const experiment::Experiment& experiment);

/// The conditions of one store with their flights, in the order of the sweep.
[[nodiscard]] std::vector<ConditionTrials> read_trials(const store::ResultStore& results);

/// A parameter of worlds on an axis: "Base stations per km²"; its own name if it has no other.
[[nodiscard]] std::string title_of_parameter(const std::string& key);

/// "Energy (kJ)", "Handovers".
[[nodiscard]] std::string title_of(const flight::Metric& metric);
/// "kJ", "handovers".
[[nodiscard]] std::string heading_of(const flight::Metric& metric);

/// The order of every table and chart: by the ranks of the agents (agents/look.hpp).
[[nodiscard]] bool shown_before(const AgentTrials& a, const AgentTrials& b);

/// Values of two agents on the same worlds: pairs of indices into their lists, by trial.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> pairs(const AgentTrials& a, const AgentTrials& b);

/// Only the trials in which `learner` beat `rival`; nothing if one of them has not flown.
[[nodiscard]] std::optional<ConditionTrials> selected(const ConditionTrials& all, std::string_view learner,
                                                      std::string_view rival);

/// The agent that the published claims are about: "dqn", or else the first one of type dqn; empty if there is none.
[[nodiscard]] std::string published_learner(std::span<const ConditionTrials> conditions);

}  // namespace aloft::report
