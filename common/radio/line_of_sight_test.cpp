#include "common/radio/line_of_sight.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/random.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using radio::LosRay;

namespace {

/// Whether the ray to a UAV at this height is blocked, by the definition, building by building.
bool blocked(const world::City& city, LosRay ray, world::Position uav, world::Position station, double height_m) {
  const double dx = station.x_m - uav.x_m;
  const double dy = station.y_m - uav.y_m;
  const double r = std::hypot(dx, dy);
  for (std::uint32_t iy = 0; iy < city.buildings_y; ++iy) {
    for (std::uint32_t ix = 0; ix < city.buildings_x; ++ix) {
      const world::Position centre = city.building_centre(ix, iy);
      const double lx = ((centre.x_m - uav.x_m) * dx + (centre.y_m - uav.y_m) * dy) / r;
      const double ly = ((centre.y_m - uav.y_m) * dx - (centre.x_m - uav.x_m) * dy) / r;
      if (lx <= 0 || lx >= r || std::fabs(ly) > city.building_width_m / (2 * std::sin(std::acos(-1.0) / 4))) continue;
      const double ray_m =
          ray == LosRay::published ? 30 + (height_m - 30) * lx / r : height_m + (30 - height_m) * lx / r;
      if (city.building_height_m[iy * city.buildings_x + ix] > ray_m) return true;
    }
  }
  return false;
}

double blocking_height_m(const world::City& city, LosRay ray, world::Position uav, world::Position station) {
  return radio::Skyline(city).blocking_height_m(ray, uav, station);
}

}  // namespace

TEST_CASE("one building between UAV and base station") {
  world::City city{300.0, 30.0, {}, 1, 1, 40.0, {50.0}};  // one building at (0, 0), 50 m
  const world::Position uav{-100.0, 0.0};
  const world::Position station{100.0, 0.0};
  // In the middle both rays have the same height: 30 + (h - 30)/2 >= 50 from h = 70 on.
  CHECK(blocking_height_m(city, LosRay::published, uav, station) == Approx(70.0));
  CHECK(blocking_height_m(city, LosRay::geometric, uav, station) == Approx(70.0));
  // A quarter of the way from the UAV at (-50, 0), station at (150, 0): geometric 30 + 20 / 0.75, published 30 + 20 /
  // 0.25.
  CHECK(blocking_height_m(city, LosRay::geometric, {-50.0, 0.0}, {150.0, 0.0}) == Approx(56.6667).epsilon(1e-5));
  CHECK(blocking_height_m(city, LosRay::published, {-50.0, 0.0}, {150.0, 0.0}) == Approx(110.0));
  // Beside the strip of 28.284 m, behind either end, or not higher than the masts: clear.
  CHECK(blocking_height_m(city, LosRay::published, {-100.0, 28.4}, {100.0, 28.4}) == 30.0);
  CHECK(blocking_height_m(city, LosRay::published, {-100.0, 28.2}, {100.0, 28.2}) == Approx(70.0));
  CHECK(blocking_height_m(city, LosRay::published, {10.0, 0.0}, {100.0, 0.0}) == 30.0);
  CHECK(blocking_height_m(city, LosRay::published, {-100.0, 0.0}, {-10.0, 0.0}) == 30.0);
  city.building_height_m = {30.0};
  CHECK(blocking_height_m(city, LosRay::published, uav, station) == 30.0);
  CHECK(blocking_height_m(city, LosRay::published, uav, uav) == 30.0);
}

TEST_CASE("blocking heights agree with the definition at every height, and are monotone") {
  const auto ray = GENERATE(LosRay::published, LosRay::geometric);
  const auto* distribution = GENERATE("poisson", "rayleigh");
  const Parameters world = radio::resolve_generated_world(
      {{"building_height_distribution", distribution}, {"bs_density_per_km2", 5}}, "world");
  RandomStream stream(3, 0, "test positions");
  int thresholds_inside = 0;
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const world::City city = world::generate_city(world, 11, trial);
    const radio::Skyline skyline(city);
    for (const world::Position station : city.base_stations) {
      const world::Position uav{stream.uniform(-505.0, 495.0), stream.uniform(-10.0, 10.0)};
      const double threshold_m = skyline.blocking_height_m(ray, uav, station);
      if (threshold_m > 40.0 && threshold_m < 240.0) ++thresholds_inside;
      for (double height_m = 40.0; height_m <= 240.0; height_m += 10.0)
        REQUIRE(blocked(city, ray, uav, station, height_m) == (height_m < threshold_m));
      if (threshold_m > 30.0) {
        REQUIRE(blocked(city, ray, uav, station, threshold_m - 1e-6));
        REQUIRE_FALSE(blocked(city, ray, uav, station, threshold_m + 1e-6));
      }
    }
  }
  CHECK(thresholds_inside > 20);
}

TEST_CASE("blocking heights agree with the definition among many high buildings") {
  const auto ray = GENERATE(LosRay::published, LosRay::geometric);
  const double window_m = GENERATE(500.0, 1700.0, 4000.0);
  const Parameters world = radio::resolve_generated_world({{"preset", "geometric"},
                                                           {"building_density_per_km2", 1500},
                                                           {"route_start_x_m", -200},
                                                           {"steps", 20},
                                                           {"bs_density_per_km2", 50},
                                                           {"window_m", window_m}},
                                                          "world");
  const world::City city = world::generate_city(world, 11, 0);
  const radio::Skyline skyline(city);
  RandomStream stream(4, 0, "test positions");
  int blocked_links = 0;
  for (std::size_t k = 0; k < 60 && k < city.base_stations.size(); ++k) {
    // Also outside of the city, and along the axes.
    world::Position uav{stream.uniform(-0.6 * window_m, 0.6 * window_m),
                        stream.uniform(-0.6 * window_m, 0.6 * window_m)};
    if (k % 8 == 3) uav.x_m = city.base_stations[k].x_m;
    if (k % 8 == 5) uav.y_m = city.base_stations[k].y_m;
    const double threshold_m = skyline.blocking_height_m(ray, uav, city.base_stations[k]);
    if (threshold_m == 30.0) {
      REQUIRE_FALSE(blocked(city, ray, uav, city.base_stations[k], 30.0 + 1e-6));
      continue;
    }
    ++blocked_links;
    REQUIRE(blocked(city, ray, uav, city.base_stations[k], threshold_m * (1 - 1e-9)));
    REQUIRE_FALSE(blocked(city, ray, uav, city.base_stations[k], threshold_m * (1 + 1e-9)));
  }
  CHECK(blocked_links > 5);
}
