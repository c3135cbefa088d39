#include "common/radio/measured_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/base/read_file.hpp"
#include "common/world/measured_flight.hpp"
#include "tests/published_data.hpp"

using namespace aloft;

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
