// A reading alone has the bits of the column's reading.
#include "common/radio/spot.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <vector>

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

TEST_CASE("a scan has the cells of the reading, strongest power first") {
  for (const json& given :
       {json{{"bs_density_per_km2", 5}}, json{{"preset", "3gpp-uma"}}, json{{"preset", "geometric"}, {"neighbours", 5}},
        json{{"bs_density_per_km2", 5}, {"candidates", 3}, {"neighbours", 2}}}) {
    INFO(given.dump());
    const Parameters world = radio::resolve_generated_world(given, "world");
    const world::City city = world::generate_city(world, 8, 1);
    const auto map = radio::make_generated_map(world, city, 8, 1);
    const auto stations = static_cast<std::int32_t>(city.base_stations.size());
    const auto measured =
        static_cast<std::size_t>(std::max(world.integer("candidates"), world.integer("neighbours") + 1));
    for (const std::uint32_t point : {0U, 50U, 99U})
      for (const std::uint32_t height : {0U, 77U, 200U}) {
        const world::Position place = map->advance(point, map->start(), -1);
        const radio::Reading reading = map->reading(point, place, height);
        radio::CellScan scan;
        map->scan(point, place, height, {}, scan);
        REQUIRE(scan.cells.size() == measured);
        CHECK(scan.neighbours == static_cast<std::uint32_t>(world.integer("neighbours")));
        const auto best = std::max_element(
            scan.cells.begin(), scan.cells.begin() + world.integer("candidates"),
            [](const radio::CellReading& a, const radio::CellReading& b) { return a.sinr_db < b.sinr_db; });
        CHECK(best->cell == reading.serving_cell);
        CHECK(same_bits(best->sinr_db, reading.serving_sinr_db));
        CHECK(same_bits(best->qos, reading.qos));
        for (std::size_t i = 1; i < measured; ++i) CHECK(scan.cells[i - 1].power_dbm >= scan.cells[i].power_dbm);

        // All cells on request: each once, the first ones as before, and no other one stronger.
        std::vector<std::int32_t> all(static_cast<std::size_t>(stations));
        std::iota(all.begin(), all.end(), 0);
        radio::CellScan every;
        map->scan(point, place, height, all, every);
        REQUIRE(every.cells.size() == all.size());
        std::set<std::int32_t> cells;
        for (std::size_t i = 0; i < all.size(); ++i) {
          cells.insert(every.cells[i].cell);
          if (i < measured) {
            CHECK(every.cells[i].cell == scan.cells[i].cell);
            CHECK(same_bits(every.cells[i].power_dbm, scan.cells[i].power_dbm));
            CHECK(same_bits(every.cells[i].sinr_db, scan.cells[i].sinr_db));
          } else {
            CHECK(every.cells[i].power_dbm <= scan.cells.back().power_dbm);
          }
        }
        CHECK(cells.size() == all.size());
      }
  }
}

TEST_CASE("powers of a scan are in dBm: without fading and beams they give the SINRs") {
  const Parameters world =
      radio::resolve_generated_world({{"fading", "none"}, {"uav_antenna", "omnidirectional"}}, "world");
  const world::City city = world::generate_city(world, 8, 0);
  const auto map = radio::make_generated_map(world, city, 8, 0);
  std::vector<std::int32_t> all(city.base_stations.size());
  std::iota(all.begin(), all.end(), 0);
  radio::CellScan scan;
  map->scan(50, map->advance(50, map->start(), -1), 60, all, scan);
  const auto mw = [](double dbm) { return std::pow(10.0, dbm / 10.0); };
  double sum_mw = mw(-174.0 + 10.0 * std::log10(20e6) + 10.0);  // noise
  for (const radio::CellReading& cell : scan.cells) sum_mw += mw(cell.power_dbm);
  for (const radio::CellReading& cell : scan.cells) {
    const double sinr = mw(cell.power_dbm) / (sum_mw - mw(cell.power_dbm));
    CHECK(cell.sinr_db == Approx(10.0 * std::log10(sinr)).margin(1e-6));
    CHECK(cell.qos == Approx(std::log2(1.0 + sinr)).epsilon(1e-6));
  }
}
