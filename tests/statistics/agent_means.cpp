#include "tests/statistics/agent_means.hpp"

#include <fmt/format.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/flight/flight.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

namespace aloft::statistics {
namespace {

constexpr std::uint64_t seed = 20221;

/// Expected means over trials, bit/s/Hz, from two independent implementations of the model (3,000-4,000 trials); the
/// gain of the height filter over min-height from 4,000 worlds, NaN if unknown.
struct Expected {
  Densities densities;
  double random_walk;
  double one_step_ahead;
  double height_filter_gain;
};
const std::vector<Expected> expected_means{
    {{1, 200}, 17.30, 18.87, 0.3},  {{2.5, 200}, 9.65, 14.06, 2.5}, {{5, 200}, 4.61, 10.13, 3.05},
    {{2.5, 100}, 9.62, 14.18, NAN}, {{2.5, 300}, 9.82, 14.02, NAN},
};

const Expected& expected_for(const Densities& densities) {
  for (const Expected& expected : expected_means)
    if (expected.densities.bs_per_km2 == densities.bs_per_km2 &&
        expected.densities.buildings_per_km2 == densities.buildings_per_km2)
      return expected;
  throw std::logic_error("no expected means for these densities");
}

void check_mean(const std::string& what, const Sample& sample, double expected) {
  std::cout << fmt::format("  {:<28} {:7.3f} +- {:.3f}   expected {:.2f}\n", what, sample.mean,
                           sample.sd / std::sqrt(sample.trials), expected);
  INFO(what << ": " << sample.mean << ", expected " << expected);
  CHECK(std::fabs(sample.mean - expected) <= sample.tolerance());
}

}  // namespace

double Sample::tolerance() const {
  return 3.0 * sd / std::sqrt(static_cast<double>(trials)) + 0.1;
}

Sample sample_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / (n - 1.0)), static_cast<std::uint32_t>(values.size())};
}

nlohmann::json world_with(const Densities& densities) {
  return {{"bs_density_per_km2", densities.bs_per_km2}, {"building_density_per_km2", densities.buildings_per_km2}};
}

Sample gain_over_min_height(const nlohmann::json& agent, const nlohmann::json& world, std::uint32_t trials) {
  const auto means = fly_trials(world, {"min-height", agent}, trials);
  std::vector<double> gains;
  for (std::uint32_t trial = 0; trial < trials; ++trial) gains.push_back(means[1][trial] - means[0][trial]);
  const Sample gain = sample_of(gains);
  std::cout << fmt::format("{} - min-height, {}: {:+.3f} +- {:.3f}\n", agent.dump(), world.dump(), gain.mean,
                           gain.sd / std::sqrt(gain.trials));
  return gain;
}

std::vector<std::vector<double>> fly_trials(const nlohmann::json& given, const nlohmann::json& agents,
                                            std::uint32_t trials) {
  std::vector<agents::AgentSpec> specs;
  for (const auto& entry : agents) specs.push_back(agents::parse_agents(entry, "agents").front());
  const Parameters world = radio::resolve_generated_world(given, "world");
  std::vector<std::vector<double>> means(specs.size(), std::vector<double>(trials));
  std::atomic<std::uint32_t> next = 0;
  const auto fly_some = [&] {
    for (std::uint32_t trial = next++; trial < trials; trial = next++) {
      const world::City city = world::generate_city(world, seed, trial);
      const auto map = radio::make_generated_map(world, city, seed, trial);
      for (std::size_t a = 0; a < specs.size(); ++a)
        means[a][trial] = flight::fly(*map, seed, trial, *specs[a].make(), specs[a]).qos_mean();
    }
  };
  std::jthread helper(fly_some);
  fly_some();
  helper.join();
  return means;
}

void check_expected_means(const Densities& densities, std::uint32_t trials) {
  const Expected& expected = expected_for(densities);
  std::cout << fmt::format("{} BS per km2, {} buildings per km2, {} trials\n", densities.bs_per_km2,
                           densities.buildings_per_km2, trials);
  const auto means =
      fly_trials(world_with(densities), {"random-walk", "one-step-ahead", "min-height", "height-filter"}, trials);
  check_mean("random-walk", sample_of(means[0]), expected.random_walk);
  check_mean("one-step-ahead", sample_of(means[1]), expected.one_step_ahead);
  if (std::isnan(expected.height_filter_gain)) return;
  std::vector<double> gains;
  for (std::uint32_t trial = 0; trial < trials; ++trial) gains.push_back(means[3][trial] - means[2][trial]);
  check_mean("height-filter - min-height", sample_of(gains), expected.height_filter_gain);
}

}  // namespace aloft::statistics
