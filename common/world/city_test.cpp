#include "common/world/city.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/random.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

Parameters parameters(const json& given) {
  return Parameters(world::city_parameters(), given, "world");
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments building_heights(const json& given) {
  const Parameters world = parameters(given);
  double sum = 0.0;
  double squares = 0.0;
  double n = 0.0;
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    for (const double height_m : world::generate_city(world, 1, trial).building_height_m) {
      sum += height_m;
      squares += height_m * height_m;
      n += 1.0;
    }
  }
  return {sum / n, squares / n - (sum / n) * (sum / n)};
}

}  // namespace

TEST_CASE("buildings stand on a grid of 42 by 43 at 200 per km2") {
  const world::City city = world::generate_city(parameters(json::object()), 1, 0);
  CHECK(city.buildings_x == 42);  // sqrt(1800) = 42.43
  CHECK(city.buildings_y == 43);
  CHECK(city.building_height_m.size() == 42U * 43U);
  CHECK(city.building_centre(0, 0).x_m == Approx(-1500.0 + 3000.0 * 0.5 / 42));
  CHECK(city.building_centre(41, 42).y_m == Approx(1500.0 - 3000.0 * 0.5 / 43));
  for (const double density_per_km2 : {0.0, 0.1}) {  // 0.1: less than one building on average
    const world::City open = world::generate_city(parameters({{"building_density_per_km2", density_per_km2}}), 1, 0);
    CHECK(open.buildings_x == 0);
    CHECK(open.buildings_y == 0);
    CHECK(open.building_height_m.empty());
  }
}

TEST_CASE("base stations are Poisson in number and uniform in place") {
  const Parameters world = parameters({{"bs_density_per_km2", 5}});
  double sum = 0.0;
  double squares = 0.0;
  double x = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  const int trials = 2000;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const world::City city = world::generate_city(world, 1, trial);
    const auto n = static_cast<double>(city.base_stations.size());
    sum += n;
    squares += n * n;
    for (const world::Position& station : city.base_stations) {
      REQUIRE(std::fabs(station.x_m) < 1500.0);
      REQUIRE(std::fabs(station.y_m) < 1500.0);
      x += station.x_m;
      xx += station.x_m * station.x_m;
      xy += station.x_m * station.y_m;
    }
  }
  const double mean = sum / trials;
  CHECK(mean == Approx(45.0).margin(3 * std::sqrt(45.0 / trials)));
  CHECK(squares / trials - mean * mean == Approx(45.0).margin(4.5));
  CHECK(x / sum == Approx(0.0).margin(9.0));           // standard error 866 / sqrt(90,000) = 2.9
  CHECK(xx / sum == Approx(750'000.0).epsilon(0.01));  // 3000^2 / 12
  CHECK(xy / sum / 750'000.0 == Approx(0.0).margin(0.012));
}

TEST_CASE("base stations on a hexagonal grid have six neighbours at equal distances, and the grid is shifted") {
  CHECK(world::hexagonal_distance_m(4.6188) == Approx(500.0).epsilon(1e-5));
  CHECK(world::hexagonal_distance_m(0.38493) == Approx(1732.0).epsilon(1e-4));
  const Parameters world = parameters({{"bs_density_per_km2", 4.6188}, {"deployment", "hexagonal"}});
  const double distance_m = world::hexagonal_distance_m(4.6188);
  double count = 0.0;
  double x_m = 0.0;
  const int trials = 100;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const world::City city = world::generate_city(world, 1, trial);
    count += static_cast<double>(city.base_stations.size());
    for (const world::Position& station : city.base_stations) {
      REQUIRE((std::fabs(station.x_m) <= 1500.0 && std::fabs(station.y_m) <= 1500.0));
      x_m += station.x_m;
      if (std::fabs(station.x_m) > 1500.0 - distance_m || std::fabs(station.y_m) > 1500.0 - distance_m) continue;
      int neighbours = 0;
      for (const world::Position& other : city.base_stations) {
        const double apart_m = std::hypot(other.x_m - station.x_m, other.y_m - station.y_m);
        if (apart_m > 0.0 && apart_m < 1.5 * distance_m) {
          REQUIRE(apart_m == Approx(distance_m));
          ++neighbours;
        }
      }
      REQUIRE(neighbours == 6);
    }
  }
  // 9 km2 x 4.6188; the count of a trial varies by a few at the edges.
  CHECK(count / trials == Approx(41.57).margin(0.6));
  CHECK(x_m / count == Approx(0.0).margin(50.0));
}

TEST_CASE("three cells stand at each site, the sites are those of one cell each") {
  const world::City one = world::generate_city(parameters(json::object()), 1, 0);
  const world::City three = world::generate_city(parameters({{"cells_per_site", "three"}}), 1, 0);
  REQUIRE(three.base_stations.size() == 3 * one.base_stations.size());
  for (std::size_t k = 0; k < three.base_stations.size(); ++k) {
    CHECK(three.base_stations[k].x_m == one.base_stations[k / 3].x_m);
    CHECK(three.base_stations[k].y_m == one.base_stations[k / 3].y_m);
  }
}

TEST_CASE("cities with too few base stations are drawn again") {
  const Parameters world = parameters({{"bs_density_per_km2", 0.5}});  // mean 4.5, at least 6
  double sum = 0.0;
  for (std::uint32_t trial = 0; trial < 1000; ++trial) {
    const std::size_t n = world::generate_city(world, 1, trial).base_stations.size();
    REQUIRE(n >= 6);
    sum += static_cast<double>(n);
  }
  // Mean of a Poisson(4.5) number given that it is at least 6: 4.5 P(n >= 5) / P(n >= 6) = 4.5 * 0.46790 / 0.29707.
  CHECK(sum / 1000 == Approx(7.0877).margin(0.15));
  CHECK_THROWS_AS(world::generate_city(parameters({{"bs_density_per_km2", 0.1}, {"min_base_stations", 100}}), 1, 0),
                  InputError);
}

TEST_CASE("a city with more base stations than fading can number is refused with their count") {
  std::vector<ParameterSpec> table = world::city_parameters();
  for (ParameterSpec& spec : table)
    if (spec.name == "bs_density_per_km2") spec.maximum = 1e6;
  const auto made = [&](double density_per_km2) {
    return world::generate_city(Parameters(table, {{"bs_density_per_km2", density_per_km2}, {"window_m", 1000}}, "w"),
                                1, 0);
  };
  CHECK(made(65'000).base_stations.size() > 64'000);
  CHECK_THROWS_WITH(made(66'500), Catch::Contains("trial 0 has 66") && Catch::Contains("base stations; at most 65536"));
}

TEST_CASE("the probability of enough base stations") {
  const auto enough = [](double density_per_km2, int least) {
    return world::probability_of_enough_stations(
        parameters({{"bs_density_per_km2", density_per_km2}, {"window_m", 1000}, {"min_base_stations", least}}));
  };
  CHECK(enough(1, 1) == Approx(0.63212056));    // 1 - 1/e
  CHECK(enough(4.5, 6) == Approx(0.29706951));  // from a table of the Poisson distribution
  CHECK(enough(500, 6) == Approx(1.0));
}

TEST_CASE("building heights have the distribution's mean and variance") {
  // 90,300 heights: standard error of the mean 0.015 (Poisson), 0.035 (Rayleigh)
  const Moments poisson = building_heights(json::object());
  CHECK(poisson.mean == Approx(20.0).margin(0.06));
  CHECK(poisson.variance == Approx(20.0).epsilon(0.02));
  const Moments rayleigh =
      building_heights({{"building_height_distribution", "rayleigh"}, {"building_height_mean_m", 25.0663}});
  CHECK(rayleigh.mean == Approx(25.0663).margin(0.14));
  CHECK(rayleigh.variance == Approx((2.0 - std::acos(-1.0) / 2.0) * 400.0).epsilon(0.02));  // scale 20 m
  const Moments zero = building_heights({{"building_height_mean_m", 0}});
  CHECK(zero.mean == 0.0);
}

TEST_CASE("a Poisson height is the least one whose probability not to be exceeded is above the building's number") {
  const double mean_m = GENERATE(0.0, 0.4, 20.0, 500.0);
  const world::City city = world::generate_city(parameters({{"building_height_mean_m", mean_m}}), 1, 5);
  RandomStream stream(1, 5, "building heights");
  for (const double height_m : city.building_height_m) {
    const double u = stream.uniform();
    double below = 0.0;  // P(height < height_m)
    for (int k = 0; k < height_m; ++k) below += std::exp(k * std::log(mean_m) - mean_m - std::lgamma(k + 1.0));
    const double at =
        mean_m == 0.0 ? 1.0 : std::exp(height_m * std::log(mean_m) - mean_m - std::lgamma(height_m + 1.0));
    REQUIRE(below <= u + 1e-9);
    REQUIRE(u < below + at + 1e-9);
  }
}

TEST_CASE("conditions share random numbers, trials and seeds do not") {
  const world::City one = world::generate_city(parameters({{"bs_density_per_km2", 1}}), 1, 3);
  const world::City five = world::generate_city(parameters({{"bs_density_per_km2", 5}}), 1, 3);
  CHECK(one.building_height_m == five.building_height_m);
  CHECK(one.base_stations[0].x_m == five.base_stations[0].x_m);
  CHECK(one.base_stations[5].y_m == five.base_stations[5].y_m);
  const world::City other_trial = world::generate_city(parameters({{"bs_density_per_km2", 5}}), 1, 4);
  const world::City other_seed = world::generate_city(parameters({{"bs_density_per_km2", 5}}), 2, 3);
  CHECK(other_trial.base_stations[0].x_m != five.base_stations[0].x_m);
  CHECK(other_seed.base_stations[0].x_m != five.base_stations[0].x_m);
  CHECK(other_trial.building_height_m != five.building_height_m);
}
