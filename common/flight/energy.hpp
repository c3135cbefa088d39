#pragma once

namespace aloft::flight {

/// The costs of a flight, which an experiment sets.
struct Costs {
  double speed_m_per_s = 10.0;  ///< along the route
  double energy_weight = 0.0;   ///< subtracted from the reward, per joule
  double handover_cost = 0.0;   ///< subtracted from the reward, per handover
  double step_length_m = 10.0;  ///< of the route; files of measured flights do not have it
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
