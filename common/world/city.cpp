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

/// Whether base stations stand on a hexagonal grid.
constexpr std::array<Choice<bool>, 2> deployments{{{"poisson", false}, {"hexagonal", true}}};

ParameterSpec deployment_parameter() {
  ParameterSpec spec = choice_parameter("deployment", deployments,
                                        "Base stations: at random places, or on a hexagonal grid, shifted at random.");
  spec.default_is_implied = true;  // worlds from before there was a choice name none
  return spec;
}

constexpr std::array<Choice<std::uint32_t>, 2> cells_of_sites{{{"one", 1}, {"three", 3}}};

ParameterSpec cells_parameter() {
  ParameterSpec spec = choice_parameter("cells_per_site", cells_of_sites,
                                        "Base stations at each place of one: three have azimuths of 30, 150 and 270 "
                                        "degrees, and antennas of `3gpp`.");
  spec.default_is_implied = true;
  return spec;
}

/// Whether heights are Rayleigh distributed.
constexpr std::array<Choice<bool>, 2> height_distributions{{{"poisson", false}, {"rayleigh", true}}};

double mean_base_stations(const Parameters& world) {
  const double window_m = world.number("window_m");
  return world.number("bs_density_per_km2") * window_m * window_m / m2_per_km2;
}

std::size_t count_of(std::uint32_t count) {
  return count;
}
std::size_t count_of(const std::vector<Position>& stations) {
  return stations.size();
}

void check_count(std::size_t count, std::uint32_t trial) {
  if (count > limits::base_stations)
    throw InputError(
        "bs_density_per_km2 and window_m: the city of trial {} has {} base stations; at most {} are "
        "possible: lower the density or the window",
        trial, count, limits::base_stations);
}

/// `draw` again and again until there are min_base_stations of them.
template <typename Draw>
auto draw_enough(const Parameters& world, const Draw& draw) {
  const double mean = mean_base_stations(world);
  const auto least = static_cast<std::size_t>(world.integer("min_base_stations"));
  for (int redraw = 0; redraw < largest_redraws; ++redraw) {
    auto drawn = draw(mean);
    if (count_of(drawn) >= least) return drawn;
  }
  throw InputError(
      "bs_density_per_km2 and window_m: with {:g} base stations on average, none of {} cities had the {} "
      "that min_base_stations asks for; raise the density or the window, or lower min_base_stations",
      mean, largest_redraws, least);
}

std::vector<Position> random_stations(const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  RandomStream counts(seed, trial, "base station count");
  const std::uint32_t count = draw_enough(world, [&](double mean) {
    const std::uint32_t drawn = counts.poisson(mean);
    check_count(drawn, trial);
    return drawn;
  });
  const double edge_m = 0.5 * world.number("window_m");
  RandomStream positions(seed, trial, "base station positions");
  std::vector<Position> stations(count);
  for (Position& station : stations) {
    station.x_m = positions.uniform(-edge_m, edge_m);
    station.y_m = positions.uniform(-edge_m, edge_m);
  }
  return stations;
}

/// The part in the city of a grid of equilateral triangles with one base station per 1 / density, whose rows run along
/// x, shifted at random.
std::vector<Position> hexagonal_stations(const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  const double edge_m = 0.5 * world.number("window_m");
  const double distance_m = hexagonal_distance_m(world.number("bs_density_per_km2"));
  const double row_m = 0.5 * std::numbers::sqrt3 * distance_m;
  RandomStream shifts(seed, trial, "hexagonal grid");
  return draw_enough(world, [&](double /*mean*/) {
    const double first_x_m = -edge_m - 1.5 * distance_m + shifts.uniform(0.0, distance_m);
    const double first_y_m = -edge_m - 2.0 * row_m + shifts.uniform(0.0, 2.0 * row_m);
    std::vector<Position> stations;
    for (int row = 0; first_y_m + row * row_m < edge_m; ++row)
      for (int column = 0;; ++column) {
        const Position station{first_x_m + (column + 0.5 * (row % 2)) * distance_m, first_y_m + row * row_m};
        if (station.x_m >= edge_m) break;
        if (station.x_m >= -edge_m && station.y_m >= -edge_m) stations.push_back(station);
      }
    check_count(stations.size(), trial);
    return stations;
  });
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
      number_parameter("bs_density_per_km2", 2.5, 0.1, 500.0,
                       "Base stations per km2; at random places their number is Poisson."),
      deployment_parameter(),
      cells_parameter(),
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

std::uint32_t cells_per_site(const Parameters& world) {
  return world.chosen("cells_per_site", cells_of_sites);
}

double hexagonal_distance_m(double density_per_km2) {
  return std::sqrt(2.0 / std::numbers::sqrt3 * m2_per_km2 / density_per_km2);
}

double probability_of_enough_stations(const Parameters& world) {
  const double mean = mean_base_stations(world);
  if (world.chosen("deployment", deployments)) return mean >= world.integer("min_base_stations") ? 1.0 : 0.0;
  double probability = std::exp(-mean);  // of exactly k stations
  double too_few = 0.0;
  for (int k = 0; k < world.integer("min_base_stations"); probability *= mean / ++k) too_few += probability;
  return 1.0 - too_few;
}

City generate_city(const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  City city;
  city.window_m = world.number("window_m");
  city.base_station_height_m = world.number("base_station_height_m");
  city.base_stations = world.chosen("deployment", deployments) ? hexagonal_stations(world, seed, trial)
                                                               : random_stations(world, seed, trial);
  if (const std::uint32_t cells = cells_per_site(world); cells > 1) {
    std::vector<Position> stations;
    for (const Position& site : city.base_stations) stations.insert(stations.end(), cells, site);
    check_count(stations.size(), trial);
    city.base_stations = std::move(stations);
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
