#pragma once

namespace aloft::flight {

/// What a flight costs besides quality: an experiment's options.
struct Costs {
  double speed_m_per_s = 10.0;  ///< along the route
  double energy_weight = 0.0;   ///< off the reward, per joule
  double handover_cost = 0.0;   ///< off the reward, per handover
  double step_length_m = 10.0;  ///< of the route; measured flights say nothing about theirs
};

/// What a rotary-wing UAV needs to fly level at this speed, hovering included. Eq. (12) with the constants of table I
/// (20 N, four blades, rotor radius 0.4 m) of Zeng, Xu, Zhang, Energy Minimization for Wireless Communication With
/// Rotary-Wing UAV (2019); speed >= 0.
[[nodiscard]] double level_power_w(double speed_m_per_s) noexcept;

/// One step with this change of height: level flight for its duration, and, going up, weight x climb
/// over the efficiency of the drive, 0.7. Going down gives nothing back. Turns, wind and the time that a climb takes
/// are left out.
[[nodiscard]] double step_energy_j(const Costs& costs, double climb_m) noexcept;

}  // namespace aloft::flight
