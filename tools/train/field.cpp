#include "tools/train/field.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/agents/training_worlds.hpp"
#include "common/base/random.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

namespace aloft::train {
namespace {

agents::PretrainedReport report_of(radio::QosKind kind, std::uint32_t level, const radio::Reading& reading) {
  agents::Observation observation;
  observation.serving_sinr_db = reading.serving_sinr_db;
  observation.neighbour_count = reading.neighbour_count;
  observation.neighbour_sinr_db = reading.neighbour_sinr_db;
  observation.qos = reading.qos;
  return agents::pretrained_report(kind, level, observation);
}

/// A random whole number from low to high, both included.
std::uint32_t between(RandomStream& random, std::uint32_t low, std::uint32_t high) {
  return low + random.uniform_index(high - low + 1);
}

/// One value per level, standard deviation 1, correlation r from each level to the next.
void correlated_levels(RandomStream& random, double r, std::vector<double>& to) {
  double value = random.normal();
  for (double& x : to) {
    x = value;
    value = r * value + std::sqrt(1.0 - r * r) * random.normal();
  }
}

}  // namespace

Field field_of(radio::SignalMap& map) {
  const radio::HeightGrid& grid = map.heights();
  Field field{map.qos_kind(), (grid.size() - 1) / grid.indices_per_step() + 1, map.steps(), map.result_point(1), {}};
  world::Position position = map.start();
  for (std::uint32_t point = 0; point <= map.result_point(map.steps()); ++point) {
    if (point > 0) position = map.advance(point, position, -1);
    const auto& column = map.column(point, position);
    for (std::uint32_t k = 0; k < field.levels; ++k) {
      field.reports.push_back(report_of(field.kind, k, column[k * grid.indices_per_step()]));
    }
  }
  return field;
}

Field generated_field(double bs_density_per_km2, std::uint64_t seed, std::uint32_t trial) {
  const Parameters world =
      radio::resolve_generated_world({{"bs_density_per_km2", bs_density_per_km2},
                                      {"building_density_per_km2", agents::training_worlds.building_density_per_km2},
                                      {"height_resolution_m", 10.0}},
                                     "world");
  const world::City city = world::generate_city(world, seed, trial);
  return field_of(*radio::make_generated_map(world, city, seed, trial));
}

Field random_throughput_field(std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, "throughput field");
  Field field{radio::QosKind::throughput,
              between(random, agents::training_worlds.measured_levels_min, agents::training_worlds.measured_levels_max),
              between(random, agents::training_worlds.measured_steps_min, agents::training_worlds.measured_steps_max),
              0,
              {}};
  const double fall = random.uniform(-0.1, 0.6);  // from the lowest height to far above
  const double fall_levels = random.uniform(1.0, 8.0);
  const double constant_sd = random.uniform(0.05, 0.25);
  const double constant_r = std::exp(-1.0 / random.uniform(1.0, 8.0));
  const double change_sd = random.uniform(0.05, 0.4);
  const double change_r = std::exp(-1.0 / random.uniform(0.3, 4.0));
  const double persistence = random.uniform(0.8, 0.99);
  const double noise_sd = random.uniform(0.0, 0.06);
  std::vector<double> constant(field.levels);
  std::vector<double> change(field.levels);
  std::vector<double> fresh(field.levels);
  correlated_levels(random, constant_r, constant);
  correlated_levels(random, change_r, change);
  for (std::uint32_t step = 1; step <= field.steps; ++step) {
    for (std::uint32_t k = 0; k < field.levels; ++k) {
      const double quality = 1.0 - fall * (1.0 - std::exp(-static_cast<double>(k) / fall_levels)) +
                             constant_sd * constant[k] + change_sd * change[k] + noise_sd * random.normal();
      field.reports.push_back({k, static_cast<float>(std::max(quality, 0.02)), {}});
    }
    correlated_levels(random, change_r, fresh);
    for (std::uint32_t k = 0; k < field.levels; ++k)
      change[k] = persistence * change[k] + std::sqrt(1.0 - persistence * persistence) * fresh[k];
  }
  return field;
}

std::vector<double> best_values(const Field& field, double discount) {
  const std::size_t levels = field.levels;
  std::vector<double> value((field.steps + 1) * levels, 0.0);
  for (std::uint32_t step = field.steps; step-- > 0;) {
    for (std::size_t k = 0; k < levels; ++k) {
      double best = -1e300;
      for (std::size_t to = k > 0 ? k - 1 : 0; to <= std::min(k + 1, levels - 1); ++to)
        best = std::max(best, static_cast<double>(field.report(step + 1, static_cast<std::uint32_t>(to)).qos) +
                                  discount * value[(step + 1) * levels + to]);
      value[step * levels + k] = best;
    }
  }
  return value;
}

}  // namespace aloft::train
