#include "tools/importer/imported_world.hpp"

#include <catch2/catch.hpp>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::importer;
using Catch::Contains;

TEST_CASE("heights are the multiples of the step in the data, or those asked for") {
  CHECK(imported_heights({}, 18.0, 42.0, "x") == std::vector<double>{20, 30, 40});
  CHECK(imported_heights({}, 20.0, 40.0, "x") == std::vector<double>{20, 30, 40});
  CHECK(imported_heights({}, -3.0, 12.0, "x") == std::vector<double>{0, 10});
  CHECK(imported_heights({.min_m = 25.0, .max_m = 36.0, .step_m = 5.0}, 0, 100, "x") ==
        std::vector<double>{25, 30, 35});
  CHECK(imported_heights({.step_m = 0.1}, 1.0, 1.3, "x").size() == 4);
  CHECK_THROWS_WITH(imported_heights({}, 21.0, 35.0, "x.csv"),
                    Contains("x.csv: 1 heights from 30 to 30 m") && Contains("data are from 21 to 35 m high"));
  CHECK_THROWS_AS(imported_heights({.min_m = 50.0, .max_m = 20.0}, 0, 100, "x"), InputError);
  CHECK_THROWS_AS(imported_heights({.step_m = 0.05}, 0, 100, "x"), InputError);
}

TEST_CASE("places lie every 10 m along a way, around its corners") {
  // 15 m east, then north: 0, 10, and 5 m around the corner
  const auto places = places_along({{0, 0}, {15, 0}, {15, 0}, {15, 25}}, "x");
  REQUIRE(places.size() == 5);
  CHECK(places[1].x_m == Approx(10.0));
  CHECK(places[2].x_m == Approx(15.0));
  CHECK(places[2].y_m == Approx(5.0));
  CHECK(places[4].y_m == Approx(25.0));
  CHECK(places_along({{3, 4}}, "x").size() == 1);
  CHECK(places_along({{3, 4}, {3, 4}}, "x").size() == 1);
  CHECK_THROWS_WITH(places_along({{0, 0}, {170e3, 0}}, "x"), Contains("163.84 km") && Contains("16384 steps"));
}

TEST_CASE("a measured world's file has the columns that are known") {
  ImportedWorld world{
      .height_m = {20, 30}, .route = {{53.5, -6.25}}, .values = {{1000.04, 3.456, 7, true}, {2e4, -1, 8, false}}};
  CHECK(to_csv(world) ==
        "step,height_m,throughput_kbps,latitude,longitude\n1,20,1000.0,53.5000000,-6.2500000\n"
        "1,30,20000.0,53.5000000,-6.2500000\n");
  world.has_sinr = world.has_cells = world.has_observed = true;
  CHECK(to_csv(world) ==
        "step,height_m,throughput_kbps,latitude,longitude,sinr_db,serving_cell,observed\n"
        "1,20,1000.0,53.5000000,-6.2500000,3.46,7,1\n1,30,20000.0,53.5000000,-6.2500000,-1.00,8,0\n");
}

TEST_CASE("points are two numbers") {
  CHECK(parse_point("--route", "53.5,-6.25").y_m == -6.25);
  for (const char* text : {"", "53", "53,", ",6", "a,b", "1,2,3", "nan,1", "1e999,1"})
    CHECK_THROWS_WITH(parse_point("--route", text), Contains("--route"));
}
