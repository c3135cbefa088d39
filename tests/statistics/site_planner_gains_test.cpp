#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/statistics/agent_means.hpp"

using namespace aloft::statistics;
using nlohmann::json;

namespace {

double gain(json world, double bs_per_km2, const char* agent = "site-planner") {
  world["bs_density_per_km2"] = bs_per_km2;
  INFO(world.dump());
  return gain_over_min_height(agent, world, 300).mean;
}

}  // namespace

TEST_CASE("site-planner gains what an independent implementation gained on the same trials") {
  CHECK(gain(json::object(), 1) == Approx(1.33).margin(0.05));
  CHECK(gain(json::object(), 2.5) == Approx(5.48).margin(0.05));
  CHECK(gain(json::object(), 5) == Approx(7.99).margin(0.05));
  CHECK(gain({{"building_density_per_km2", 100}}, 2.5) == Approx(5.76).margin(0.05));
  CHECK(gain({{"building_density_per_km2", 300}}, 2.5) == Approx(5.39).margin(0.05));
}

TEST_CASE("site-planner with wrong maps, which it weighs by its reports") {
  CHECK(gain({{"site_map_error_m", 10}}, 2.5) >= 4.6);
  CHECK(gain({{"site_map_error_m", 25}}, 2.5) >= 3.8);
  CHECK(gain({{"site_map_error_m", 50}}, 2.5) >= 3.5);
  CHECK(gain({{"site_map_error_m", 10}}, 5) >= 6.2);
  CHECK(gain({{"site_map_error_m", 25}}, 5) >= 6.0);  // the mean without weights: 5.3
  CHECK(gain({{"site_map_error_m", 50}}, 5) >= 4.7);  // 4.05
}

TEST_CASE("site-planner with a short horizon, gaps in the map, or correlated fading") {
  CHECK(gain({{"site_map_route_points", 20}}, 2.5) >= 5.2);
  CHECK(gain({{"site_map_route_points", 10}}, 5) >= 6.2);
  CHECK(gain({{"site_map_missing", 0.1}}, 2.5) >= 4.1);
  CHECK(gain({{"fading", "correlated"}}, 2.5) >= 5.2);
}

TEST_CASE("site-planner where buildings block most links") {
  const json geometric{{"preset", "geometric"}};
  // The best agent with reports only: 6.5 and 2.2. With line of sight everywhere: -0.6 at 2.5 BS per km2.
  for (const double bs_per_km2 : {1.0, 2.5})
    CHECK(gain(geometric, bs_per_km2) > gain(geometric, bs_per_km2, "height-filter") + 0.2);
  // Heights hardly matter in the world of the paper's text: no agent is better than the lowest by more than 0.01.
  CHECK(gain({{"preset", "paper-text"}}, 2.5) == Approx(0.0).margin(0.02));
}
