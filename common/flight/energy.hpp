#pragma once

#include <optional>

#include "common/radio/serving_rule.hpp"

namespace aloft::flight {

/// What a flight costs, and what it is measured by: an experiment and its world set this.
struct Costs {
  double speed_m_per_s = 10.0;         ///< along the route
  double energy_weight = 0.0;          ///< subtracted from the reward, per joule
  double handover_cost = 0.0;          ///< subtracted from the reward, per handover
  double step_length_m = 10.0;         ///< of the route; files of measured flights do not have it
  double handover_loss = 1.0;          ///< factor of the quality in the reward of a step with handovers
  double outage_threshold_db = -6.0;   ///< SINR below which the time counts as outage
  std::optional<radio::A3Rules> a3{};  ///< how the serving cell changes; nothing: it is the strongest at every place

  [[nodiscard]] double step_s() const noexcept { return step_length_m / speed_m_per_s; }
};

/// Propulsion power of a rotary-wing UAV in level flight at this speed; 0 is hovering. Eq. (12) with the constants of
/// table I (20 N, four blades, rotor radius 0.4 m) of Zeng, Xu, Zhang, Energy Minimization for Wireless Communication
/// With Rotary-Wing UAV (IEEE Trans. Wireless Commun., 2019); speed >= 0.
[[nodiscard]] double level_power_w(double speed_m_per_s) noexcept;

/// Energy of one step with this change of height: level flight for its duration and, in a climb, weight x climb divided
/// by the drive's efficiency, 0.7. A descent costs as much as level flight. Turns, wind and the time that a climb takes
/// are not modelled.
[[nodiscard]] double step_energy_j(const Costs& costs, double climb_m) noexcept;

}  // namespace aloft::flight
