#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/radio/reading.hpp"

namespace aloft::agents {

using radio::max_neighbours;
using radio::QosKind;

enum class Action : std::uint8_t {
  none,  ///< before the first step
  down,
  hold,
  up,
  absolute,  ///< jump to a height: only for agents declared unconstrained
};

/// A quality in the units in which learners are tuned: Mbit/s, or bit/s/Hz.
[[nodiscard]] constexpr double in_learning_units(double qos, QosKind kind) noexcept {
  return qos * (kind == QosKind::throughput ? 1e-3 : 1.0);
}

/// The facts about a flight that every agent knows before it.
struct FlightInfo {
  QosKind qos = QosKind::spectral_efficiency;
  double height_min_m = 0.0;
  double height_max_m = 0.0;
  double height_step_m = 0.0;
  std::uint32_t steps = 0;  ///< actions in this flight
  std::uint64_t seed = 0;   ///< with `trial`: keys of the agent's own random streams
  std::uint32_t trial = 0;
};

/// The report of the UAV's modem and autopilot after a step, the only input of an unprivileged agent.
/// Step 0 is the situation before the first action (executed = none; reward and qos are not scored).
struct Observation {
  std::uint32_t step = 0;
  double height_m = 0.0;
  std::int32_t serving_cell = -1;
  double serving_sinr_db = 0.0;
  std::uint32_t neighbour_count = 0;
  std::array<double, max_neighbours> neighbour_sinr_db{};  ///< descending
  double qos = 0.0;                                        ///< unit: FlightInfo::qos
  Action executed =
      Action::none;     ///< the action that led here, after clamping to the height limits, whichever agent commanded it
  double reward = 0.0;  ///< of that action; unit of qos
  bool last = false;    ///< the flight ends here; no command is expected
};

/// Quality at every allowed height where the result of one step will be read. Privileged.
struct HeightProfile {
  std::uint32_t step = 0;  ///< the step whose result is read there, 1..steps
  double height_min_m = 0.0;
  double resolution_m = 0.0;
  std::vector<double> qos;  ///< [i]: at height_min_m + i * resolution_m
};

}  // namespace aloft::agents
