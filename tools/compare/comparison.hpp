#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/statistics.hpp"
#include "common/store/result_store.hpp"

namespace aloft::compare {

/// One of the two result folders.
struct Side {
  const experiment::Experiment& experiment;
  std::vector<store::FlightSummary> flights;
};

/// One agent under one condition that both sides have. QoS is the mean of a flight, in the condition's unit.
struct AgentComparison {
  std::string condition;
  std::string agent;
  agents::Privilege privilege = agents::Privilege::none;  ///< the higher of the two sides
  experiment::WorldKind kind = experiment::WorldKind::generated;
  bool paired = false;        ///< on the same trials; otherwise all flights of A against all of B
  std::size_t flights_a = 0;  ///< in the mean of A
  std::size_t flights_b = 0;
  std::size_t in_both = 0;    ///< trials that both sides have flown
  std::size_t identical = 0;  ///< trials of `in_both` with the same digest
  double qos_mean_a = 0.0;
  double qos_mean_b = 0.0;
  double difference = 0.0;                              ///< mean of B - A
  std::optional<experiment::Interval> difference_ci95;  ///< none for one flight or equal values
};

/// A flight that both sides have with different digests.
struct DifferentFlight {
  experiment::FlightKey a;
  experiment::FlightKey b;
};

struct Comparison {
  bool same_experiment = false;         ///< equal ids
  bool paired = false;                  ///< equal seeds: trial i of A and trial i of B have the same random numbers
  std::vector<AgentComparison> agents;  ///< in A's order of conditions, then A's order of agents
  std::size_t in_both = 0;
  std::size_t identical = 0;
  std::size_t only_a = 0;  ///< flights whose condition, trial or agent the other side lacks
  std::size_t only_b = 0;
  std::optional<DifferentFlight> first_different;

  /// True if both sides hold the same flights, byte for byte.
  [[nodiscard]] bool all_identical() const noexcept { return only_a == 0 && only_b == 0 && identical == in_both; }
};

/// Compares what the two sides share: conditions and agents by name. With equal seeds differences are taken on the same
/// trials (95 % bootstrap interval of their mean). With different seeds the worlds differ, and the interval of the
/// difference follows from the intervals of the two means by the method of variance estimates recovery (Zou and
/// Donner, Statistics in Medicine 27, 2008, Eq. 2). Throws InputError if nothing is shared.
[[nodiscard]] Comparison compare(const Side& a, const Side& b);

/// Where the resolved experiments differ in what can change a result: JSON path, value of A, value of B; at most
/// `limit`.
struct SettingDifference {
  std::string path;
  std::string a;
  std::string b;
};
[[nodiscard]] std::vector<SettingDifference> setting_differences(const experiment::Experiment& a,
                                                                 const experiment::Experiment& b, std::size_t limit);

}  // namespace aloft::compare
