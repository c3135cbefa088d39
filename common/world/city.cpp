#include "common/world/city.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/random.hpp"

namespace aloft::world {
namespace {

constexpr double m2_per_km2 = 1e6;
constexpr int largest_redraws = 100'000;

/// Whether heights are Rayleigh distributed.
constexpr std::array<Choice<bool>, 2> height_distributions{{{"poisson", false}, {"rayleigh", true}}};

double mean_base_stations(const Parameters& world) {
  const double window_m = world.number("window_m");
  return world.number("bs_density_per_km2") * window_m * window_m / m2_per_km2;
}

std::uint32_t base_station_count(const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  const double mean = mean_base_stations(world);
  const auto least = static_cast<std::uint32_t>(world.integer("min_base_stations"));
  RandomStream stream(seed, trial, "base station count");
  for (int redraw = 0; redraw < largest_redraws; ++redraw) {
    const std::uint32_t count = stream.poisson(mean);
    if (count > limits::base_stations)
      throw InputError(
          "bs_density_per_km2 and window_m: the city of trial {} has {} base stations; at most {} are "
          "possible: lower the density or the window",
          trial, count, limits::base_stations);
    if (count >= least) return count;
  }
  throw InputError(
      "bs_density_per_km2 and window_m: with {:g} base stations on average, none of {} cities had the {} "
      "that min_base_stations asks for; raise the density or the window, or lower min_base_stations",
      mean, largest_redraws, least);
}

/// Heights that are Poisson or Rayleigh distributed, by inversion: one uniform number per building.
class HeightDistribution {
 public:
  explicit HeightDistribution(const Parameters& world)
      : mean_m_(world.number("building_height_mean_m")),
        rayleigh_(world.chosen("building_height_distribution", height_distributions)) {
    if (rayleigh_) return;
    fill_cumulative();
    fill_guide();
  }

  [[nodiscard]] double height_m(double u) const {
    if (rayleigh_) return mean_m_ * std::sqrt(2.0 / std::numbers::pi) * std::sqrt(-2.0 * std::log(u));
    std::size_t height = guide_[static_cast<std::size_t>(u * guide_size)];
    while (cumulative_[height] <= u) ++height;
    return static_cast<double>(height);
  }

 private:
  /// cumulative_[k] = P(height <= k m), up to the k beyond which the probability vanishes in rounding, and 1.
  void fill_cumulative() {
    double probability = std::exp(-mean_m_);
    double sum = probability;
    for (int k = 1; k <= mean_m_ || probability > 1e-18; ++k) {
      cumulative_.push_back(sum);
      probability *= mean_m_ / k;
      sum += probability;
    }
    cumulative_.push_back(1.0);
  }

  /// guide_[i]: the height of u = i / guide_size, where the search begins for greater ones.
  void fill_guide() {
    std::size_t height = 0;
    for (std::size_t i = 0; i < guide_size; ++i) {
      while (cumulative_[height] <= static_cast<double>(i) / guide_size) ++height;
      guide_[i] = height;
    }
  }

  static constexpr std::size_t guide_size = 1024;  // a power of two: exact in floating point

  double mean_m_;
  bool rayleigh_;
  std::vector<double> cumulative_;
  std::array<std::size_t, guide_size> guide_{};
};

}  // namespace

const std::vector<ParameterSpec>& city_parameters() {
  static const std::vector<ParameterSpec> table = {
      number_parameter("bs_density_per_km2", 2.5, 0.1, 500.0, "Base stations per km2; their number is Poisson."),
      integer_parameter("min_base_stations", 6, 1, 100, "Cities with fewer base stations are drawn again."),
      number_parameter("window_m", 3000.0, 100.0, 10'000.0, "Side of the square city, centred on (0, 0)."),
      number_parameter("base_station_height_m", 30.0, 1.0, 200.0, "Height of every base station antenna."),
      number_parameter("building_density_per_km2", 200.0, 0.0, 2000.0, "Buildings per km2, on a regular grid."),
      number_parameter("building_width_m", 40.0, 1.0, 500.0, "Width of every building."),
      choice_parameter("building_height_distribution", height_distributions,
                       "Distribution of building heights, independent between buildings."),
      number_parameter("building_height_mean_m", 20.0, 0.0, 500.0,
                       "Mean building height; the scale of a Rayleigh distribution is 0.7979 times its mean."),
  };
  return table;
}

double probability_of_enough_stations(const Parameters& world) {
  const double mean = mean_base_stations(world);
  double probability = std::exp(-mean);  // of exactly k stations
  double too_few = 0.0;
  for (int k = 0; k < world.integer("min_base_stations"); probability *= mean / ++k) too_few += probability;
  return 1.0 - too_few;
}

City generate_city(const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  City city;
  city.window_m = world.number("window_m");
  city.base_station_height_m = world.number("base_station_height_m");

  RandomStream positions(seed, trial, "base station positions");
  city.base_stations.resize(base_station_count(world, seed, trial));
  for (Position& station : city.base_stations) {
    station.x_m = positions.uniform(-0.5 * city.window_m, 0.5 * city.window_m);
    station.y_m = positions.uniform(-0.5 * city.window_m, 0.5 * city.window_m);
  }
  draw_buildings(world, seed, trial, city);
  return city;
}

void draw_buildings(const Parameters& world, std::uint64_t seed, std::uint32_t trial, City& city) {
  city.window_m = world.number("window_m");
  city.building_width_m = world.number("building_width_m");
  const double buildings = world.number("building_density_per_km2") * city.window_m * city.window_m / m2_per_km2;
  city.buildings_x = static_cast<std::uint32_t>(std::floor(std::sqrt(buildings)));
  city.buildings_y = city.buildings_x == 0 ? 0 : static_cast<std::uint32_t>(std::ceil(std::sqrt(buildings)));
  const HeightDistribution distribution(world);
  RandomStream heights(seed, trial, "building heights");
  city.building_height_m.resize(std::size_t{city.buildings_x} * city.buildings_y);
  heights.uniforms(city.building_height_m);
  for (double& height_m : city.building_height_m) height_m = distribution.height_m(height_m);
}

}  // namespace aloft::world
