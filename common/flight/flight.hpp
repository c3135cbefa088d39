#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/flight/energy.hpp"
#include "common/flight/mobility.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::flight {

/// One scored step of a flight, as it is stored.
struct StepRecord {
  std::uint32_t step = 0;
  agents::Action action = agents::Action::none;  ///< as executed
  double x_m = 0.0;
  double y_m = 0.0;
  double height_m = 0.0;
  std::int32_t serving_cell = -1;
  double serving_sinr_db = 0.0;
  double qos = 0.0;
  double reward = 0.0;
  std::uint32_t flown_by = 0;  ///< index into FlightRecord::pilots
  std::optional<agents::Introspection> introspection;
  MobilityEvents mobility{};  ///< none where the strongest cell serves
};

/// A finished flight.
struct FlightRecord {
  radio::QosKind qos_kind = radio::QosKind::spectral_efficiency;
  std::vector<std::string> pilots;  ///< names of the agents that commanded, in order of first appearance
  std::vector<StepRecord> steps;

  [[nodiscard]] double qos_mean() const;  ///< over all steps, fixed order
  [[nodiscard]] double height_mean_m() const;
  [[nodiscard]] std::uint32_t height_changes()
      const;  ///< steps whose height differs from the one before (start: height_min_m)
  /// The energy of one step, by its index, and of the whole flight.
  [[nodiscard]] double step_energy_j(std::size_t index, const Costs& costs) const;
  [[nodiscard]] double energy_j(const Costs& costs) const;
  /// Where the strongest cell serves: changes of serving cell from step to step; steps with an unknown cell (-1) are
  /// skipped. Nothing if no cell is known at all.
  [[nodiscard]] std::optional<std::uint32_t> handovers() const;
  /// Where networks hand the UAV over: the events of all steps together.
  [[nodiscard]] MobilityEvents mobility() const;
  /// Time without a cell, or with an SINR below the threshold of outage.
  [[nodiscard]] double outage_s(const Costs& costs) const;
  double height_start_m = 0.0;
};

/// The episode state machine: applies height commands, moves the UAV, measures the radio. No DDS, no files, no clock.
class Flight {
 public:
  /// `map` must outlive the flight. The reward of a step is its quality minus what it costs.
  Flight(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, const Costs& costs = {});

  [[nodiscard]] const agents::FlightInfo& info() const noexcept { return info_; }
  /// What the UAV reports now: step 0 before the first command.
  [[nodiscard]] const agents::Observation& observation() const noexcept { return observation_; }
  [[nodiscard]] bool finished() const noexcept { return observation_.last; }
  /// In the last step.
  [[nodiscard]] std::uint32_t handovers() const noexcept { return handovers_; }

  /// Whether the whole route is known before the flight.
  [[nodiscard]] bool fixed_route() const noexcept { return map_.fixed_route(); }

  /// Whether an operator tells the route ahead step by step.
  [[nodiscard]] bool route_told_in_parts() const {
    const radio::Survey* survey = map_.survey();
    return survey != nullptr && survey->map.route_points > 0;
  }

  /// Privileged: quality over heights where the result of `step` will be read. Without a fixed route only the next step
  /// is known; for others it throws std::logic_error.
  [[nodiscard]] agents::HeightProfile profile(std::uint32_t step) const;
  /// The same, into memory that the caller reuses.
  void profile(std::uint32_t step, agents::HeightProfile& into) const;

  /// What an operator knows at the present step. `update`: without the sites. InputError if nobody knows where the base
  /// stations are, or if the route depends on the flight.
  [[nodiscard]] agents::SiteMap site_map(bool update) const;

  /// Executes one command by `pilot`. Moves are clamped to the height limits; an absolute height is rounded to the
  /// map's grid and clamped. The caller has checked that the agent may use it. Throws std::logic_error after the last
  /// step.
  void step(const agents::Command& command, std::string_view pilot);

  [[nodiscard]] const FlightRecord& record() const& noexcept { return record_; }
  [[nodiscard]] FlightRecord record() && noexcept { return std::move(record_); }

 private:
  /// Where the result of the next step (or, with a fixed route, of any step) is read.
  [[nodiscard]] world::Position result_position(std::uint32_t step) const noexcept;
  /// Changes level_ and returns the action after clamping.
  agents::Action move(const agents::Command& command);
  /// Reads the radio at route point `point`, the UAV's present one.
  void measure(std::uint32_t point);
  void measure_strongest(std::uint32_t point);
  /// As a network serves the UAV after its past.
  void measure_served(std::uint32_t point);
  /// Quality minus costs of a step that changed the height by `climb_m`.
  [[nodiscard]] double reward(double climb_m) const;
  /// Of the step that was just measured; notes the serving cell.
  std::uint32_t count_handovers();
  std::uint32_t pilot_index(std::string_view pilot);

  radio::SignalMap& map_;
  Costs costs_;
  agents::FlightInfo info_;
  agents::Observation observation_;
  FlightRecord record_;
  world::Position position_;
  std::uint32_t level_ = 0;        // index into the map's height grid
  std::int32_t scored_cell_ = -1;  // the last known serving cell of a scored step; -1: none
  std::uint32_t handovers_ = 0;    // in the last step
  std::optional<Mobility> mobility_;
  MobilityEvents events_;  // of the last step
  radio::CellScan scan_;
};

/// What an agent with this privilege is to survey before it observes flight.observation(), if anything. `first`: it has
/// observed no report of this flight yet. Throws InputError as Flight::site_map.
[[nodiscard]] std::optional<agents::SiteMap> survey(const Flight& flight, agents::Privilege privilege, bool first);

/// Calls `deliver` with each profile that an agent with this privilege may foresee before it observes
/// flight.observation(): none, that of the next step, or, before the first command, those of all steps in order.
/// `buffer` is overwritten. Throws InputError if the privilege is the whole route, but the route depends on the flight.
void foresee(const Flight& flight, agents::Privilege privilege, agents::HeightProfile& buffer,
             const std::function<void(const agents::HeightProfile&)>& deliver);

/// Executes a command of `pilot`. Throws std::logic_error if it jumps to a height, but its type may not.
void execute(Flight& flight, const agents::Command& command, const agents::AgentSpec& pilot);

/// Flies `agent` to the end by direct calls, as --in-process does. The protocol on the bus must give the same flight.
[[nodiscard]] FlightRecord fly(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, agents::Agent& agent,
                               const agents::AgentSpec& spec, const Costs& costs = {});

}  // namespace aloft::flight
