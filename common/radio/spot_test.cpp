// A reading alone has the bits of the column's reading.
#include "common/radio/spot.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void require_same(const radio::Reading& alone, const radio::Reading& in_column) {
  REQUIRE(alone.serving_cell == in_column.serving_cell);
  REQUIRE(same_bits(alone.qos, in_column.qos));
  REQUIRE(same_bits(alone.serving_sinr_db, in_column.serving_sinr_db));
  REQUIRE(alone.neighbour_count == in_column.neighbour_count);
  for (std::size_t j = 0; j < radio::max_neighbours; ++j)
    REQUIRE(same_bits(alone.neighbour_sinr_db.at(j), in_column.neighbour_sinr_db.at(j)));
}

/// Compares every height at some points, beside the route and above a base station, too. Two maps: one that is asked
/// for columns would read from them.
void check_world(const json& given, std::uint32_t trials = 2) {
  INFO(given.dump());
  const Parameters world = radio::resolve_generated_world(given, "world");
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const world::City city = world::generate_city(world, 8, trial);
    const auto whole = radio::make_generated_map(world, city, 8, trial);
    const auto single = radio::make_generated_map(world, city, 8, trial);
    for (const std::uint32_t point : {0U, 31U, 62U, 93U}) {
      const world::Position on_route = whole->advance(point, whole->start(), -1);
      for (const world::Position place :
           {on_route, world::Position{on_route.x_m, 17.0}, city.base_stations[point % 6]}) {
        const auto& column = whole->column(point, place);
        for (std::uint32_t i = static_cast<std::uint32_t>(column.size()); i-- > 0;) {
          INFO("trial " << trial << ", point " << point << ", height index " << i);
          require_same(single->reading(point, place, i), column[i]);
          require_same(whole->reading(point, place, i), column[i]);
        }
      }
    }
  }
}

json with(json world, const json& more) {
  world.update(more);
  return world;
}

}  // namespace

TEST_CASE("a reading alone has the column's bits for every channel model") {
  for (const radio::LinkModelType& model : radio::link_model_types())
    for (const double density_per_km2 : {1.0, 2.5, 5.0})
      check_world({{"propagation", model.name}, {"bs_density_per_km2", density_per_km2}});
}

TEST_CASE("a reading alone has the column's bits for every preset, antenna and kind of fading") {
  for (const char* preset : {"published", "paper-text", "geometric"}) {
    check_world({{"preset", preset}}, 4);
    for (const char* uav : {"directional", "omnidirectional"})
      for (const char* bs : {"array", "sector"})
        for (const char* fading : {"independent", "none", "correlated"})
          check_world({{"preset", preset},
                       {"uav_antenna", uav},
                       {"bs_antenna", bs},
                       {"fading", fading},
                       {"bs_density_per_km2", 5},
                       {"height_resolution_m", 5}},
                      1);
  }
}

TEST_CASE("a reading alone has the column's bits for every choice of cells, ray and exponent") {
  const json dense{{"bs_density_per_km2", 5}, {"height_resolution_m", 5}};
  check_world(with(dense, {{"serving_selection", "best-of-all"}}));
  check_world(with(dense, {{"neighbours", 0}}));
  check_world(with(dense, {{"neighbours", 5}, {"candidates", 1}}));
  check_world(with(dense, {{"candidates", 20}, {"min_base_stations", 20}}));
  check_world({{"bs_density_per_km2", 0.7}, {"candidates", 6}, {"min_base_stations", 6}});  // sometimes all of them
  check_world(with(dense, {{"fading", "correlated"}, {"fading_correlation", 0.9}}));
  check_world(with(dense, {{"los_ray", "geometric"}, {"path_distance", "horizontal"}}));
  check_world(with(dense, {{"path_exponent_los", 4}, {"path_exponent_nlos", 3.3}}));
  check_world(with(dense, {{"building_height_distribution", "rayleigh"}, {"building_density_per_km2", 900}}));
  check_world(with(dense, {{"building_density_per_km2", 0}, {"height_min_m", 30}, {"interferer_distance_max_m", 500}}));
}
