#include "tools/importer/scatter.hpp"

#include <catch2/catch.hpp>

#include "common/base/error.hpp"
#include "common/world/csv_table.hpp"

using namespace aloft;
using namespace aloft::importer;
using Catch::Contains;

namespace {

ScatterColumns columns_of(Quantity quantity = Quantity::sinr_db) {
  ScatterColumns columns;
  columns.value = "value";
  columns.quantity = quantity;
  return columns;
}

std::string error_of(const std::string& csv, const ScatterColumns& columns = columns_of()) {
  try {
    static_cast<void>(parse_scatter(csv, "log.csv", columns));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

const std::string header = "latitude,longitude,altitude,value\n";

}  // namespace

TEST_CASE("samples are read by the names of their columns, all others are ignored") {
  ScatterColumns columns = columns_of(Quantity::throughput_kbps);
  columns.latitude = "Lat";
  columns.altitude = "alt m";
  columns.cell = "PCI";
  columns.time = "when";
  columns.kbps_per_unit = 1e3;
  columns.ground_m = 12.0;
  const Scatter scatter = parse_scatter(
      "when,note,alt m,Lat,longitude,PCI,value\n"
      "2026-05-01T12:00:01.5Z,\"a, b\",42,0,0,5,17.5\n\"1777636800\",,32,0,\"0.002\",6,2\n",
      "log.csv", columns);
  REQUIRE(scatter.samples.size() == 2);
  CHECK(scatter.has_cells);
  CHECK(scatter.has_times);
  CHECK(scatter.middle.longitude_deg == Approx(0.001));
  CHECK(scatter.samples[0].height_m == 30.0);
  CHECK(scatter.samples[0].value == 17'500.0);
  CHECK(scatter.samples[0].cell == 5);
  CHECK(scatter.samples[0].time_s - scatter.samples[1].time_s == 1.5);       // 1777636800 is that noon
  CHECK(scatter.samples[1].position.x_m == Approx(111.3195).epsilon(1e-5));  // 0.001 degrees of the equator
  CHECK_FALSE(parse_scatter(header + "0,0,20,5\n", "log.csv", columns_of()).has_times);
}

TEST_CASE("dates are seconds since 1970") {
  CHECK(world::seconds_of_date("1970-01-01T00:00:00Z") == 0.0);
  CHECK(world::seconds_of_date("2000-03-01 00:00:00") == 951'868'800.0);
  CHECK(world::seconds_of_date("2000-03-01T02:30:00.25+02:30") == 951'868'800.25);
  CHECK(world::seconds_of_date("2000-02-29T22:00:00-02:00") == 951'868'800.0);
  for (const char* text :
       {"", "2000", "2000-03-01", "2000-13-01T00:00:00Z", "2001-02-29T00:00:00Z", "2000-03-01T24:00:00Z",
        "2000-03-01T00:60:00Z", "2000-03-01T00:00:00X", "2000-03-01T00:00:00+2", "2000-03-01T00:00Z",
        "2000-03-01T00:00:nanZ", "20x0-03-01T00:00:00Z"})
    CHECK_FALSE(world::seconds_of_date(text).has_value());
}

TEST_CASE("bad measurements are refused with file, line, column and range") {
  CHECK_THAT(error_of(""), Contains("log.csv:1:1: ") && Contains("empty"));
  CHECK_THAT(error_of(header), Contains("log.csv:2:1: ") && Contains("one row per sample"));
  CHECK_THAT(error_of("latitude,longitude,altitude,valu\n1,2,3,4\n"),
             Contains("log.csv:1:1: the header has no column 'value'") && Contains("Did you mean 'valu'") &&
                 Contains("latitude, longitude, altitude, valu"));
  ScatterColumns with_cell = columns_of();
  with_cell.cell = "cell";
  CHECK_THAT(error_of(header, with_cell), Contains("no column 'cell'"));
  CHECK_THAT(error_of("latitude,longitude,altitude,value,cell\n1,2,3,4,1.5\n", with_cell),
             Contains("log.csv:2:9: cell is '1.5'; use a whole number from 0 to 2147483647"));
  CHECK_THAT(error_of(header + "0,0,20,5\n0,0,20,nan\n"), Contains("log.csv:3:8: value is 'nan'") && Contains("200"));
  CHECK_THAT(error_of(header + "0,0,20,\n"), Contains("log.csv:2:8: value is ''"));
  CHECK_THAT(error_of(header + "91,0,20,5\n"), Contains("log.csv:2:1: latitude is '91'; use a number from -90 to 90"));
  CHECK_THAT(error_of(header + "0,0,1e5,5\n"), Contains("log.csv:2:5: altitude") && Contains("-1000 to 20000"));
  CHECK_THAT(error_of(header + "0,0,20,60\n", columns_of(Quantity::rsrp_dbm)), Contains("-200 to 50"));
  CHECK_THAT(error_of(header + "0,0,20,30\n", columns_of(Quantity::rsrq_db)), Contains("-60 to 20"));
  CHECK_THAT(error_of(header + "0,0,20,-1\n", columns_of(Quantity::throughput_kbps)), Contains("from 0 to"));
  CHECK_THAT(error_of(header + "0,0,20,5\n1,0,20,5\n0,0,20,5\n"),
             Contains("log.csv:3:1: 74 km from the middle of the samples; at most 50 km"));
  CHECK_THAT(error_of(header + "0,0,20\n"), Contains("3 fields, but the header has 4"));
  ScatterColumns twice = columns_of();
  twice.value = "altitude";
  CHECK_THAT(error_of(header, twice), Contains("'altitude' is named for two things"));
  ScatterColumns with_time = columns_of();
  with_time.time = "time";
  CHECK_THAT(error_of("latitude,longitude,altitude,value,time\n0,0,20,5,noon\n", with_time),
             Contains("log.csv:2:10: time is 'noon'") && Contains("2026-05-01T12:00:00.5Z"));
}
