#include "common/radio/inspect.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/error.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/measured_map.hpp"
#include "common/world/city.hpp"
#include "common/world/measured_flight.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

struct Trial {
  explicit Trial(const json& given, std::uint64_t seed = 9)
      : world(radio::resolve_generated_world(given, "world")),
        city(world::generate_city(world, seed, 1)),
        map(radio::make_generated_map(world, city, seed, 1)) {}
  Parameters world;
  world::City city;
  std::unique_ptr<radio::SignalMap> map;
};

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("an explanation has the bits of the table") {
  for (const json& given : {json{{"bs_density_per_km2", 5}, {"neighbours", 5}}, json{{"preset", "paper-text"}},
                            json{{"preset", "geometric"}, {"fading_correlation", 0.9}}}) {
    Trial trial(given);
    for (std::uint32_t point = 0; point <= 100; point += 25) {
      const auto& column = trial.map->column(point, trial.map->advance(point, {}, -1));
      for (std::uint32_t i = 0; i < column.size(); i += 13) {
        const radio::Explanation explanation =
            radio::explain(trial.world, trial.city, 9, 1, point, trial.map->heights().height_m(i));
        REQUIRE(explanation.serving_cell == static_cast<std::uint32_t>(column[i].serving_cell));
        REQUIRE(explanation.serving_sinr_db == column[i].serving_sinr_db);
        REQUIRE(explanation.spectral_efficiency == column[i].qos);
        std::vector<double> others;
        for (const radio::CandidateExplanation& c : explanation.candidates)
          if (c.station != explanation.serving_cell) others.push_back(c.sinr_db);
        std::sort(others.rbegin(), others.rend());
        for (std::uint32_t j = 0; j < column[i].neighbour_count; ++j)
          REQUIRE(others.at(j) == column[i].neighbour_sinr_db.at(j));
      }
    }
  }
}

TEST_CASE("an explanation is complete as JSON and readable as text") {
  const Trial trial(json{{"bs_density_per_km2", 5}});
  const radio::Explanation explanation = radio::explain(trial.world, trial.city, 9, 1, 50, 120.0);
  const json as_json = radio::to_json(explanation);
  CHECK(as_json["stations"].size() == trial.city.base_stations.size());
  CHECK(as_json["candidates"].size() == 5);
  double interference_w = 0.0;
  for (const json& i : as_json["candidates"][0]["interferers"]) interference_w += i["interference_w"].get<double>();
  CHECK(interference_w == as_json["candidates"][0]["interference_w"].get<double>());
  CHECK(as_json["height_m"] == 120.0);
  const std::string text = radio::to_text(explanation);
  CHECK_THAT(text, Catch::Contains("Route point 50") && Catch::Contains("Serving cell") && Catch::Contains("noise"));
  CHECK(lines(text) > trial.city.base_stations.size() + 10);
}

TEST_CASE("places that are not in the table are refused") {
  const Trial trial(json::object());
  using Catch::Contains;
  CHECK_THROWS_WITH(radio::explain(trial.world, trial.city, 9, 1, 101, 40.0), Contains("use 0 to 100"));
  for (const double height_m : {39.0, 241.0, 40.5})
    CHECK_THROWS_WITH(radio::explain(trial.world, trial.city, 9, 1, 1, height_m),
                      Contains("use 40 to 240 m in steps of 1 m"));
}

TEST_CASE("a world is exported with stations, buildings and route") {
  const Trial trial(json::object());
  const json world = radio::world_to_json(trial.world, trial.city);
  CHECK(world["base_stations"].size() == trial.city.base_stations.size());
  CHECK(world["buildings"].size() == 42U * 43U);
  CHECK(world["buildings"][43]["height_m"] == trial.city.building_height_m[43]);
  CHECK(world["buildings"][43]["x_m"] == trial.city.building_centre(1, 1).x_m);
  CHECK(world["route"].size() == 101);
  CHECK(world["route"][0]["x_m"] == -505.0);
  std::ostringstream csv;
  radio::write_world_csv(csv, trial.world, trial.city);
  CHECK(lines(csv.str()) == 1 + trial.city.base_stations.size() + 42U * 43U + 101);
  CHECK_THAT(csv.str(), Catch::Contains("\nroute_point,0,-505,"));
  const Trial free(json{{"route", "serving"}});
  CHECK(radio::world_to_json(free.world, free.city)["route"].is_null());
}

TEST_CASE("a table is exported over route points and heights") {
  Trial trial(json::object());
  std::ostringstream text;
  radio::write_table_json(text, *trial.map);
  const json table = json::parse(text.str());
  CHECK(table["heights_m"].size() == 201);
  REQUIRE(table["points"].size() == 101);
  const auto& column = trial.map->column(7, trial.map->advance(7, {}, -1));
  CHECK(table["points"][7]["spectral_efficiency"][20] == column[20].qos);
  CHECK(table["points"][7]["serving_cell"][20] == column[20].serving_cell);
  std::ostringstream csv;
  radio::write_table_csv(csv, *trial.map);
  CHECK(lines(csv.str()) == 1 + 101 * 201);

  const auto measured = radio::make_measured_map(
      world::parse_measured_flight("step,height_m,throughput_kbps\n1,30,29020\n1,40,200\n", "flight.csv"));
  std::ostringstream measured_csv;
  radio::write_table_csv(measured_csv, *measured);
  CHECK(measured_csv.str().starts_with(
      "point,x_m,y_m,height_m,throughput_kbps,serving_sinr_db,serving_cell\n0,0,0,30,29020,"));

  Trial free(json{{"route", "serving"}});
  CHECK_THROWS_AS(radio::write_table_csv(csv, *free.map), InputError);
}
