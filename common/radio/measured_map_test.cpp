#include "common/radio/measured_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/base/read_file.hpp"
#include "common/world/measured_flight.hpp"
#include "tests/published_data.hpp"

using namespace aloft;

namespace {

/// Two steps, 20 to 40 m high, and two base stations.
struct Surveyed {
  world::MeasuredFlight flight = world::parse_measured_flight(
      "step,height_m,throughput_kbps\n1,20,1\n1,30,2\n1,40,3\n2,20,4\n2,30,5\n2,40,6\n", "flight.csv");
  world::MeasuredSites known{.sites = {{7, {-300.0, 2'000.0}, 90.0}, {9, {100.0, 0.0}, -30.0}},
                             .route = {{0.0, -5.0}, {0.0, 5.0}},
                             .antenna_height_m = 15.0,
                             .power_w = {},
                             .sectors = false};
};

}  // namespace

TEST_CASE("a measured map reads step j at row j, and the start at the first") {
  const auto map = radio::make_measured_map(world::parse_measured_flight(
      "step,height_m,throughput_kbps,serving_cell\n1,30,29020,5\n1,40,200,6\n2,30,300,7\n2,40,400,8\n", "flight.csv"));
  CHECK(map->qos_kind() == radio::QosKind::throughput);
  CHECK(map->steps() == 2);
  CHECK(map->heights().size() == 2);
  CHECK(map->heights().indices_per_step() == 1);
  CHECK(map->heights().height_max_m == 40.0);
  CHECK(map->fixed_route());
  CHECK(map->result_point(1) == 0);
  CHECK(map->column(0, map->start())[0].qos == 29'020.0);
  CHECK(map->column(0, map->start())[0].serving_sinr_db == Approx(3.4));
  CHECK(map->column(0, map->start())[0].serving_cell == 5);
  CHECK(map->column(0, map->start())[0].neighbour_count == 0);
  CHECK(map->column(map->result_point(2), {})[1].qos == 400.0);
}

TEST_CASE("nothing is known beforehand of a measured flight without base stations") {
  const auto map = radio::make_measured_map(Surveyed().flight);
  CHECK(map->survey() == nullptr);
  CHECK(map->advance(1, map->start(), -1).y_m == 0.0);
}

TEST_CASE("a measured flight with base stations has positions and a survey") {
  Surveyed surveyed;
  const auto map = radio::make_measured_map(surveyed.flight, surveyed.known);
  CHECK(map->start().y_m == -5.0);
  CHECK(map->advance(0, map->start(), -1).y_m == -5.0);
  CHECK(map->advance(1, map->start(), -1).y_m == 5.0);
  CHECK(map->column(1, {})[2].qos == 6.0);
  const radio::Survey* survey = map->survey();
  REQUIRE(survey != nullptr);
  REQUIRE(survey->map.sites.size() == 2);
  CHECK(survey->map.sites[0].cell == 7);
  CHECK(survey->map.sites[0].position.y_m == 2'000.0);
  CHECK(survey->map.position_error_m == 0.0);
  CHECK(survey->map.missing == 0.0);
  CHECK(survey->map.route_points == 0);
  CHECK(survey->radio.number("height_min_m") == 20.0);
  CHECK(survey->radio.number("height_max_m") == 40.0);
  CHECK(survey->radio.number("height_step_m") == 10.0);
  CHECK(survey->radio.number("base_station_height_m") == 15.0);
  CHECK(survey->radio.number("window_m") == 4'000.0);
  CHECK(survey->radio.number("tx_power_w") == 40.0);
  CHECK(survey->radio.text("bs_antenna") == "array");
}

TEST_CASE("power, sectors and masts above the lowest height in a survey") {
  Surveyed surveyed;
  surveyed.known.power_w = 10.0;
  surveyed.known.sectors = true;
  surveyed.known.antenna_height_m = 35.0;
  surveyed.known.sites[0].position.x_m = -40e3;
  const radio::Survey survey = radio::measured_survey(surveyed.flight, surveyed.known);
  CHECK(survey.radio.number("tx_power_w") == 10.0);
  CHECK(survey.radio.text("bs_antenna") == "sector");
  CHECK(survey.radio.number("base_station_height_m") == 20.0);
  CHECK(survey.radio.number("window_m") == 10'000.0);
  surveyed.known.sites[0].position = {};
  surveyed.known.sites[0].position.x_m = 1.0;
  CHECK(radio::measured_survey(surveyed.flight, surveyed.known).radio.number("window_m") == 3'000.0);
}

TEST_CASE("heights that no generated world has cannot be surveyed") {
  Surveyed surveyed;
  surveyed.flight.height_step_m = 0.01;
  CHECK_THROWS_WITH(radio::measured_survey(surveyed.flight, surveyed.known), Catch::Contains("height_step_m: 0.01"));
  surveyed.flight.height_step_m = 10.0;
  surveyed.flight.height_min_m = 0.0;
  CHECK_THROWS_WITH(radio::measured_survey(surveyed.flight, surveyed.known), Catch::Contains("height_min_m: 0"));
}

TEST_CASE("the Grand Canal Quay flight has its known means", "[needs-gcq]") {
  const auto file = test::published_file("gcq.csv");
  if (file.empty()) return;
  const auto map = radio::make_measured_map(world::parse_measured_flight(read_file(file), "flight"));
  REQUIRE(map->steps() == 170);
  REQUIRE(map->heights().size() == 11);
  double lowest = 0.0;
  double best = 0.0;
  for (std::uint32_t step = 1; step <= map->steps(); ++step) {
    const auto& column = map->column(map->result_point(step), {});
    lowest += column[0].qos;
    best +=
        std::max_element(column.begin(), column.end(), [](const auto& a, const auto& b) { return a.qos < b.qos; })->qos;
  }
  CHECK(lowest / 170 / 1000 == Approx(68.18).margin(0.01));  // Mbit/s
  CHECK(best / 170 / 1000 == Approx(82.12).margin(0.01));
}
