#include "common/world/measured_sites.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <string>

#include "common/base/error.hpp"
#include "common/world/measured_flight.hpp"

using namespace aloft;
using Catch::Contains;

namespace {

/// 200 m to the north along the meridian; the middle is 45.0009 N.
constexpr std::array<world::GeoPosition, 2> route{{{45.0, -6.0}, {45.0018, -6.0}}};

const std::string header = "cell,latitude,longitude,antenna_height_m\n";

std::string error_of(const std::string& csv) {
  try {
    static_cast<void>(world::parse_measured_sites(csv, "sites.csv", route));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

world::MeasuredSites with_azimuth(const std::string& azimuth_deg) {
  return world::parse_measured_sites(
      "azimuth_deg,cell,latitude,longitude,antenna_height_m\n" + azimuth_deg + ",1,45,-6,30\n", "sites.csv", route);
}

}  // namespace

TEST_CASE("base stations come by cell, in metres from the middle of the route") {
  const world::MeasuredSites known = world::parse_measured_sites(
      header + "260000017,45.0009,-5.99,25\n\n 7 ,45.0109,-6.0,40\r\n9,45.0009,-6.0,30\n", "sites.csv", route);
  REQUIRE(known.sites.size() == 3);
  CHECK(known.sites[0].cell == 7);
  CHECK(known.sites[0].position.x_m == 0.0);
  CHECK(known.sites[0].position.y_m == Approx(1111.32).margin(0.05));  // 0.01 degrees of latitude
  CHECK(known.sites[1].cell == 9);
  CHECK(known.sites[1].position.y_m == Approx(0.0).margin(1e-6));
  CHECK(known.sites[2].cell == 260'000'017);
  CHECK(known.sites[2].position.x_m == Approx(788.46).margin(0.05));  // 0.01 degrees of longitude
  REQUIRE(known.route.size() == 2);
  CHECK(known.route[0].y_m == Approx(-100.02).margin(0.01));
  CHECK(known.route[1].y_m == Approx(100.02).margin(0.01));
  CHECK(known.antenna_height_m == 30.0);  // the median
  CHECK_FALSE(known.power_w);
  CHECK_FALSE(known.sectors);
}

TEST_CASE("powers have a median, too") {
  const world::MeasuredSites known = world::parse_measured_sites(
      "cell,latitude,longitude,antenna_height_m,power_w\n1,45,-6,20,10\n2,45,-6,30,40\n3,45,-6,25,20\n4,45,-6,50,80\n",
      "sites.csv", route);
  CHECK(known.antenna_height_m == 27.5);
  CHECK(known.power_w == 30.0);
}

TEST_CASE("azimuths are clockwise from north in the file, and counterclockwise from east on the map") {
  CHECK(with_azimuth("0").sectors);
  CHECK(with_azimuth("0").sites[0].azimuth_deg == 90.0);
  CHECK(with_azimuth("90").sites[0].azimuth_deg == 0.0);
  CHECK(with_azimuth("120").sites[0].azimuth_deg == -30.0);
  CHECK(with_azimuth("300").sites[0].azimuth_deg == 150.0);
  CHECK(with_azimuth("360").sites[0].azimuth_deg == 90.0);
}

TEST_CASE("bad files of base stations are refused with file, line, column and reason") {
  const std::string row = "1,45,-6,30\n";
  CHECK_THAT(error_of(""), Contains("sites.csv:1:1: ") && Contains("cell, latitude, longitude"));
  CHECK_THAT(error_of(header), Contains("sites.csv:2:1: ") && Contains("one row per base station"));
  CHECK_THAT(error_of("cell,latitude,longitude,height_m\n"),
             Contains("sites.csv:1:25: ") && Contains("'height_m'") && Contains("Allowed: cell, latitude"));
  CHECK_THAT(error_of("cell,latitude,longitude\n"), Contains("sites.csv:1:1: ") && Contains("'antenna_height_m'"));
  CHECK_THAT(error_of(header + row + "x,45,-6,30\n"),
             Contains("sites.csv:3:1: ") && Contains("cell is 'x'; use a whole number from 0 to 2147483647"));
  CHECK_THAT(error_of(header + "1,91,-6,30\n"), Contains("sites.csv:2:3: ") && Contains("from -90 to 90"));
  CHECK_THAT(error_of(header + "1,45,-181,30\n"), Contains("sites.csv:2:6: ") && Contains("from -180 to 180"));
  CHECK_THAT(error_of(header + "1,45,-6,nan\n"), Contains("sites.csv:2:9: ") && Contains("from 1 to 200"));
  CHECK_THAT(error_of(header + "1,45,-6,\n"), Contains("sites.csv:2:9: "));
  CHECK_THAT(error_of(header + "1,45,-6\n"), Contains("sites.csv:2:8: ") && Contains("3 fields"));
  CHECK_THAT(error_of(header + row + "2,45,-6,30\n" + row),
             Contains("sites.csv:4:1: ") && Contains("cell 1 is already in line 2"));
  CHECK_THAT(error_of(header + "1,46,-6,30\n"),
             Contains("sites.csv:2:3: ") && Contains("111 km from the middle of the route; at most 50 km"));
  CHECK_THAT(error_of("cell,latitude,longitude,antenna_height_m,power_w\n1,45,-6,30,0\n"),
             Contains("sites.csv:2:12: ") && Contains("from 0.001 to 1000"));
  CHECK_THAT(error_of("cell,latitude,longitude,antenna_height_m,azimuth_deg\n1,45,-6,30,-1\n"),
             Contains("sites.csv:2:12: ") && Contains("from 0 to 360"));
}

TEST_CASE("more base stations than a map can have are refused") {
  std::string csv = header;
  for (int cell = 0; cell < 65'536; ++cell) csv += std::to_string(cell) + ",45,-6,30\n";
  CHECK(error_of(csv) == "accepted");
  CHECK_THAT(error_of(csv + "65536,45,-6,30\n"), Contains("sites.csv:65538:1: more than 65536 base stations"));
}

TEST_CASE("where a measured flight was: the mean of the rows of each step") {
  const std::string rows = "1,30,1,45.0,-6.0\n1,40,1,45.0002,-6.0004\n2,30,1,45.1,-6.1\n2,40,1,45.1,-6.1\n";
  const auto located = world::parse_located_flight("step,height_m,throughput_kbps,latitude,longitude\n" + rows, "x");
  CHECK(located.flight.steps == 2);
  REQUIRE(located.route.size() == 2);
  CHECK(located.route[0].latitude_deg == Approx(45.0001).epsilon(1e-12));
  CHECK(located.route[0].longitude_deg == Approx(-6.0002).epsilon(1e-12));
  CHECK(located.route[1].latitude_deg == 45.1);
  for (const std::string columns : {"sinr_db,longitude", "latitude,sinr_db"})
    CHECK(world::parse_located_flight("step,height_m,throughput_kbps," + columns + "\n" + rows, "x").route.empty());
}
