#pragma once

#include <numbers>

#include "common/radio/aerial_link.hpp"
#include "common/radio/approximations.hpp"

/// The formulas of TR 36.777 that channel models compute in vectorised loops; aerial_link.hpp has them for single
/// links, with those of low heights.
namespace aloft::radio {

[[gnu::always_inline]] inline double log10(double x) noexcept {
  return natural_log(x) * (1.0 / std::numbers::ln10);
}

/// What depends on the carrier alone.
struct CarrierLoss {
  double carrier_db = 0.0;            ///< 20 log fc, fc in GHz
  double free_space_at_1_m_db = 0.0;  ///< 20 log(40 pi fc / 3), as the rural formulas write it: c = 3e8 m/s
};

[[nodiscard]] inline CarrierLoss carrier_loss(double carrier_ghz) noexcept {
  return {20.0 * log10(carrier_ghz), 20.0 * log10(40.0 * std::numbers::pi * carrier_ghz / 3.0)};
}

[[gnu::always_inline]] inline double exp_of(double x) noexcept {
  return exp2((x < -700.0 ? -700.0 : x) / std::numbers::ln2);
}

[[gnu::always_inline]] inline double larger(double a, double b) noexcept {
  return a < b ? b : a;
}

/// d1/d + exp(-d/p1) (1 - d1/d), and 1 up to d1: the form that all scenarios share but the rural one near the ground.
[[gnu::always_inline]] inline double falling_probability(double distance_m, double d1_m, double p1_m) noexcept {
  const double near = d1_m / larger(distance_m, d1_m);
  return near + exp_of(-distance_m / p1_m) * (1.0 - near);
}

/// Table B-1, between the heights of TR 38.901 and those where it is certain.
template <AerialScenario scenario>
[[gnu::always_inline]] inline double aerial_los_probability(double distance_m, double height_m) noexcept {
  const double log_height = log10(height_m);
  if constexpr (scenario == AerialScenario::uma)
    return falling_probability(distance_m, larger(460.0 * log_height - 700.0, 18.0), 4300.0 * log_height - 3800.0);
  else if constexpr (scenario == AerialScenario::umi)
    return falling_probability(distance_m, larger(294.05 * log_height - 432.94, 18.0), 233.98 * log_height - 0.95);
  else
    return falling_probability(distance_m, larger(1350.8 * log_height - 1602.0, 18.0),
                               larger(15021.0 * log_height - 16053.0, 1000.0));
}

/// Table B-2, above the heights of TR 38.901. `log_slant`, `log_height`: log10 of the distance in space, at least 1 m,
/// and of the height of the UAV, both in m.
template <AerialScenario scenario, bool line_of_sight>
[[gnu::always_inline]] inline double aerial_path_loss_db(const CarrierLoss& carrier, double log_slant,
                                                         double log_height) noexcept {
  if constexpr (scenario == AerialScenario::uma) {
    if constexpr (line_of_sight) return 28.0 + 22.0 * log_slant + carrier.carrier_db;
    // The table has no maximum with line of sight here.
    return -17.5 + (46.0 - 7.0 * log_height) * log_slant + carrier.free_space_at_1_m_db;
  } else if constexpr (scenario == AerialScenario::umi) {
    const double los_db = larger(32.44 + 20.0 * log_slant + carrier.carrier_db,
                                 30.9 + (22.25 - 0.5 * log_height) * log_slant + carrier.carrier_db);
    if constexpr (line_of_sight) return los_db;
    return larger(los_db, 32.4 + (43.2 - 7.6 * log_height) * log_slant + carrier.carrier_db);
  } else {
    const double los_db = larger(23.9 - 1.8 * log_height, 20.0) * log_slant + carrier.free_space_at_1_m_db;
    if constexpr (line_of_sight) return los_db;
    return larger(los_db, -12.0 + (35.0 - 5.3 * log_height) * log_slant + carrier.free_space_at_1_m_db);
  }
}

/// Standard deviation of shadowing with line of sight: Table B-3, above the heights of TR 38.901.
template <AerialScenario scenario>
[[gnu::always_inline]] inline double aerial_shadowing_los_db(double height_m) noexcept {
  const auto falling = [height_m](double per_m) { return exp_of(-per_m * height_m); };
  if constexpr (scenario == AerialScenario::uma) return 4.64 * falling(0.0066);
  if constexpr (scenario == AerialScenario::rma) return 4.2 * falling(0.0046);
  const double deviation_db = 5.0 * falling(0.01);
  return deviation_db < 2.0 ? 2.0 : deviation_db;
}

}  // namespace aloft::radio
