#pragma once

#include <array>
#include <cstdint>

namespace aloft::radio {

/// Mean spectral efficiency, bit/s/Hz, of simple height rules over all steps and trials, and the mean height of
/// optimal-height, m.
struct Means {
  double minimum_height = 0.0;
  double constant_120 = 0.0;
  double constant_240 = 0.0;
  double one_step_ahead = 0.0;
  double optimal_height = 0.0;
  double height_of_optimal_m = 0.0;
};

/// One condition of the generated worlds' reference table.
struct ReferenceCondition {
  double bs_density_per_km2 = 0.0;
  double building_density_per_km2 = 0.0;
  Means expected;
  double deviation = 0.0;  ///< standard deviation of minimum height between trials
};

/// From two independent implementations of the published preset, 3,000 to 4,000 trials each; they agree to 0.1-0.2.
inline constexpr std::array<ReferenceCondition, 5> reference_conditions{{
    {1.0, 200.0, {18.10, 16.56, 14.80, 18.87, 22.27, 76.5}, 3.4},
    {2.5, 200.0, {10.32, 9.18, 9.32, 14.06, 20.33, 117.3}, 4.8},
    {5.0, 200.0, {4.69, 4.88, 7.55, 10.13, 17.39, 141.1}, 2.2},
    {2.5, 100.0, {10.15, 9.26, 9.30, 14.18, 20.27, 118.7}, 4.8},
    {2.5, 300.0, {10.65, 9.28, 9.36, 14.02, 20.44, 114.6}, 4.8},
}};

/// Flies the rules over trials 0 .. trials - 1 of a condition, read directly from the signal map.
[[nodiscard]] Means measure_means(const ReferenceCondition& condition, std::uint32_t trials);

/// Checks (Catch2) measured means of `trials` trials against the table: 3 deviation / sqrt(trials) + 0.1.
void check_means(const ReferenceCondition& condition, std::uint32_t trials);

}  // namespace aloft::radio
