#include "common/flight/energy.hpp"

#include <cmath>

namespace aloft::flight {
namespace {

// Table I of Zeng, Xu, Zhang (see energy.hpp).
constexpr double weight_n = 20.0;
constexpr double air_density_kg_per_m3 = 1.225;
constexpr double rotor_radius_m = 0.4;
constexpr double disc_area_m2 = 0.503;
constexpr double blade_speed_rad_per_s = 300.0;
constexpr double tip_speed_m_per_s = blade_speed_rad_per_s * rotor_radius_m;
constexpr double solidity = 0.05;
constexpr double fuselage_drag_ratio = 0.6;
constexpr double induced_power_factor = 0.1;
constexpr double induced_speed_m_per_s = 4.03;  // mean, in hover
constexpr double profile_drag = 0.012;

// Zeng et al. treat level flight only. An assumption: this share of the drive's power becomes lift in a climb.
constexpr double climb_efficiency = 0.7;

}  // namespace

double level_power_w(double speed_m_per_s) noexcept {
  const double square = speed_m_per_s * speed_m_per_s;
  const double blade_w = profile_drag / 8.0 * air_density_kg_per_m3 * solidity * disc_area_m2 * tip_speed_m_per_s *
                         tip_speed_m_per_s * tip_speed_m_per_s;
  const double induced_w =
      (1.0 + induced_power_factor) * weight_n * std::sqrt(weight_n / (2.0 * air_density_kg_per_m3 * disc_area_m2));
  const double relative = square / (2.0 * induced_speed_m_per_s * induced_speed_m_per_s);
  const double parasite_w =
      0.5 * fuselage_drag_ratio * air_density_kg_per_m3 * solidity * disc_area_m2 * square * speed_m_per_s;
  return blade_w * (1.0 + 3.0 * square / (tip_speed_m_per_s * tip_speed_m_per_s)) +
         induced_w * std::sqrt(std::sqrt(1.0 + relative * relative) - relative) + parasite_w;
}

double step_energy_j(const Costs& costs, double climb_m) noexcept {
  const double level_j = level_power_w(costs.speed_m_per_s) * costs.step_s();
  return climb_m > 0.0 ? level_j + weight_n * climb_m / climb_efficiency : level_j;
}

}  // namespace aloft::flight
