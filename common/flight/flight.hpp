#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
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
};

/// A finished flight.
struct FlightRecord {
  agents::QosKind qos_kind = agents::QosKind::spectral_efficiency;
  std::vector<std::string> pilots;  ///< who commanded, in order of first appearance
  std::vector<StepRecord> steps;

  [[nodiscard]] double qos_mean() const;  ///< over all steps, fixed order
  [[nodiscard]] double height_mean_m() const;
  [[nodiscard]] std::uint32_t height_changes()
      const;  ///< steps whose height differs from the one before (start: height_min_m)
  double height_start_m = 0.0;
};

/// The episode state machine: applies height commands, moves the UAV, measures the radio. No DDS, no files, no clock.
class Flight {
 public:
  /// `map` must outlive the flight.
  Flight(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial);

  [[nodiscard]] const agents::FlightInfo& info() const noexcept { return info_; }
  /// What the UAV reports now: step 0 before the first command.
  [[nodiscard]] const agents::Observation& observation() const noexcept { return observation_; }
  [[nodiscard]] bool finished() const noexcept { return observation_.last; }

  /// Privileged: quality over heights where the result of `step` will be read. With a fixed route any step may be asked
  /// for, otherwise only the next one (std::logic_error).
  [[nodiscard]] agents::HeightProfile profile(std::uint32_t step) const;

  /// Executes one command by `pilot`. Moves are clamped to the height limits; an absolute height is rounded to the
  /// map's grid and clamped. The caller has checked that the agent may use it. std::logic_error after the last step.
  void step(const agents::Command& command, std::string_view pilot);

  [[nodiscard]] const FlightRecord& record() const noexcept { return record_; }

 private:
  void measure(std::uint32_t point);

  radio::SignalMap& map_;
  agents::FlightInfo info_;
  agents::Observation observation_;
  FlightRecord record_;
  world::Position position_;
  std::uint32_t level_ = 0;  // index into the height grid
};

/// Flies `agent` to the end: the direct call that --in-process uses, and the meaning of the protocol on the bus.
[[nodiscard]] FlightRecord fly(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, agents::Agent& agent,
                               const agents::AgentSpec& spec);

}  // namespace aloft::flight
