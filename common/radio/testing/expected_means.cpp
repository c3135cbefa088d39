#include "common/radio/testing/expected_means.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

namespace aloft::radio {
namespace {

/// Adds the values of one trial's steps to the sums.
void add_trial(SignalMap& map, Means& sums) {
  const HeightGrid& heights = map.heights();
  const std::uint32_t stride = heights.indices_per_step();
  const std::uint32_t level_of_120 = static_cast<std::uint32_t>((120.0 - heights.height_min_m) / heights.resolution_m);
  const std::uint32_t top = heights.size() - 1;
  std::uint32_t level = 0;  // of one-step-ahead
  for (std::uint32_t step = 1; step <= map.steps(); ++step) {
    const std::uint32_t point = map.result_point(step);
    const auto& column = map.column(point, map.advance(point, map.start(), -1));
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i <= top; ++i)
      if (column[i].qos > column[best].qos) best = i;
    if (best > level)
      level = std::min(level + stride, top);
    else if (best < level)
      level -= std::min(level, stride);
    sums.minimum_height += column[0].qos;
    sums.constant_120 += column[std::min(step * stride, level_of_120)].qos;
    sums.constant_240 += column[std::min(step * stride, top)].qos;
    sums.one_step_ahead += column[level].qos;
    sums.optimal_height += column[best].qos;
    sums.height_of_optimal_m += heights.height_m(best);
  }
}

}  // namespace

Means measure_means(const ReferenceCondition& condition, std::uint32_t trials) {
  const Parameters world = resolve_generated_world({{"bs_density_per_km2", condition.bs_density_per_km2},
                                                    {"building_density_per_km2", condition.building_density_per_km2}},
                                                   "world");
  constexpr std::uint64_t seed = 1;
  Means means;
  for (std::uint32_t trial = 0; trial < trials; ++trial)
    add_trial(*make_generated_map(world, world::generate_city(world, seed, trial), seed, trial), means);
  const double results = 100.0 * trials;
  for (double* sum : {&means.minimum_height, &means.constant_120, &means.constant_240, &means.one_step_ahead,
                      &means.optimal_height, &means.height_of_optimal_m})
    *sum /= results;
  return means;
}

void check_means(const ReferenceCondition& condition, std::uint32_t trials) {
  const Means measured = measure_means(condition, trials);
  const Means& expected = condition.expected;
  const double tolerance = 3.0 * condition.deviation / std::sqrt(trials) + 0.1;
  INFO("base stations per km2: " << condition.bs_density_per_km2
                                 << ", buildings per km2: " << condition.building_density_per_km2);
  CHECK(measured.minimum_height == Approx(expected.minimum_height).margin(tolerance));
  CHECK(measured.constant_120 == Approx(expected.constant_120).margin(tolerance));
  CHECK(measured.constant_240 == Approx(expected.constant_240).margin(tolerance));
  CHECK(measured.one_step_ahead == Approx(expected.one_step_ahead).margin(tolerance));
  CHECK(measured.optimal_height == Approx(expected.optimal_height).margin(tolerance));
  // Heights vary more between trials: standard deviation 30 m.
  CHECK(measured.height_of_optimal_m ==
        Approx(expected.height_of_optimal_m).margin(std::max(6.0, 3.0 * 30.0 / std::sqrt(trials))));
}

}  // namespace aloft::radio
