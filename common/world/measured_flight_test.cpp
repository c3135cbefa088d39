#include "common/world/measured_flight.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/read_file.hpp"

using namespace aloft;
using Catch::Contains;

namespace {

constexpr const char* header = "step,height_m,throughput_kbps\n";

std::string error_of(const std::string& csv) {
  try {
    static_cast<void>(world::parse_measured_flight(csv, "flight.csv"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a measured flight is read into a grid, whatever the order of rows and columns") {
  const world::MeasuredFlight flight = world::parse_measured_flight(
      "throughput_kbps,step,height_m\r\n 400 ,2,40\r\n100,1,30\r\n\r\n300,2,30\r\n2e2,1,40\r\n", "flight.csv");
  CHECK(flight.height_min_m == 30.0);
  CHECK(flight.height_step_m == 10.0);
  CHECK(flight.heights == 2);
  CHECK(flight.steps == 2);
  CHECK(flight.throughput_kbps == std::vector<double>{100, 200, 300, 400});
  CHECK(flight.sinr_derived);
  CHECK(flight.serving_cell.empty());
}

TEST_CASE("optional columns are kept") {
  const world::MeasuredFlight flight = world::parse_measured_flight(
      "step,height_m,throughput_kbps,sinr_db,serving_cell,latitude,longitude,observed\n"
      "1,30,100,-3.5,17,53.3,-6.2,1\n1,40,200,4,18,53.3,-6.2,0",
      "flight.csv");
  CHECK_FALSE(flight.sinr_derived);
  CHECK(flight.sinr_db == std::vector<double>{-3.5, 4.0});
  CHECK(flight.serving_cell == std::vector<std::int32_t>{17, 18});
}

TEST_CASE("SINR follows from throughput by the published pairs") {
  CHECK(world::sinr_from_throughput_db(29'020) == Approx(3.4));
  CHECK(world::sinr_from_throughput_db(32'050) == Approx(4.9));  // half way from 3.4 to 6.4
  CHECK(world::sinr_from_throughput_db(46'760) == Approx(10.3));
  CHECK(world::sinr_from_throughput_db(76'650) == Approx(20.2));
  CHECK(world::sinr_from_throughput_db(22'960) == Approx(0.4));    // 6.06 Mbit/s below the first pair: -3 dB
  CHECK(world::sinr_from_throughput_db(106'500) == Approx(29.3));  // 29.85 Mbit/s above the last: +9.1 dB
  for (int kbps = 0; kbps < 120'000; kbps += 10)
    REQUIRE(world::sinr_from_throughput_db(kbps + 10) > world::sinr_from_throughput_db(kbps));
}

TEST_CASE("bad files are refused with file, line, column and reason") {
  const std::string rows = "1,30,100\n1,40,200\n";
  CHECK_THAT(error_of(""), Contains("flight.csv:1:1: ") && Contains("empty"));
  CHECK_THAT(error_of(header), Contains("flight.csv:2:1: ") && Contains("no rows"));
  CHECK_THAT(error_of("step,height,throughput_kbps\n" + rows),
             Contains("flight.csv:1:6: ") && Contains("'height'") && Contains("Did you mean 'height_m'"));
  CHECK_THAT(error_of("step,height_m\n1,30\n"), Contains("flight.csv:1:1: ") && Contains("'throughput_kbps'"));
  CHECK_THAT(error_of("step,height_m,step,throughput_kbps\n"), Contains("flight.csv:1:15: ") && Contains("twice"));
  CHECK_THAT(error_of(header + rows + "2,30,fast\n"),
             Contains("flight.csv:4:6: ") && Contains("throughput_kbps is 'fast'"));
  CHECK_THAT(error_of(header + rows + "2,30,12x\n"), Contains("flight.csv:4:6: ") && Contains("'12x'"));
  CHECK_THAT(error_of(header + rows + "2,30,\n"), Contains("flight.csv:4:6: ") && Contains("''"));
  CHECK_THAT(error_of(header + rows + "2,30,nan\n"), Contains("flight.csv:4:6: ") && Contains("'nan'"));
  CHECK_THAT(error_of(header + rows + "2,30,inf\n"), Contains("flight.csv:4:6: "));
  CHECK_THAT(error_of(header + rows + "2,30,-5\n"), Contains("flight.csv:4:6: ") && Contains("from 0 to"));
  CHECK_THAT(error_of(header + rows + "2.5,30,5\n"), Contains("flight.csv:4:1: ") && Contains("whole number"));
  CHECK_THAT(error_of(header + rows + "0,30,5\n"), Contains("flight.csv:4:1: ") && Contains("from 1 to 16384"));
  CHECK_THAT(error_of(header + rows + "2,30\n"), Contains("flight.csv:4:5: ") && Contains("2 fields"));
  CHECK_THAT(error_of(header + rows + "2,30,5,6\n"), Contains("flight.csv:4:8: ") && Contains("4 fields"));
  CHECK_THAT(error_of(header + rows + "1,40,7\n"),
             Contains("flight.csv:4:1: ") && Contains("step 1 at height 40 m is already in line 3"));
  CHECK_THAT(error_of(header + rows + "2,30,7\n"), Contains("without step 2 at height 40 m"));
  CHECK_THAT(error_of(header + rows + "3,30,7\n3,40,7\n"), Contains("without step 2 at height 30 m"));
  CHECK_THAT(error_of(header + rows + "16384,30,7\n"), Contains("without step 2 at height 30 m"));
  CHECK_THAT(error_of(header + rows + "1,55,7\n"),
             Contains("flight.csv:4:3: ") && Contains("55 breaks the even spacing of 10 m") && Contains("expected 50"));
  CHECK_THAT(error_of(std::string(header) + "1,30,7\n2,30,7\n"),
             Contains("flight.csv:2:3: ") && Contains("two heights"));
}

TEST_CASE("measured flights beyond the limits of the wire are refused") {
  const auto flight = [](int steps, int heights, double spacing_m, const char* kbps) {
    std::string csv = header;
    for (int step = 1; step <= steps; ++step)
      for (int level = 0; level < heights; ++level)
        csv += std::to_string(step) + "," + std::to_string(100.0 + spacing_m * level) + "," + kbps + "\n";
    return csv;
  };
  CHECK(error_of(flight(limits::steps, limits::cells / limits::steps, 1, "5")) == "accepted");
  CHECK_THAT(error_of(flight(limits::steps, limits::cells / limits::steps + 1, 1, "5")),
             Contains("flight.csv:2:1: 16384 steps of 65 heights are too many; at most 1048576 values"));
  CHECK_THAT(error_of(flight(20'000, 2, 1, "5")), Contains("flight.csv:32770:1: ") && Contains("from 1 to 16384"));
  CHECK(error_of(flight(1, 2, 1e-3, "5")) == "accepted");
  CHECK(1000.001 - 1000.0 < 0.001);  // 1 mm apart, but less in binary
  CHECK(world::parse_measured_flight(std::string(header) + "1,1000,5\n1,1000.001,5\n", "x").height_step_m == 0.001);
  CHECK_THAT(error_of(flight(1, 2, 1e-4, "5")),
             Contains("flight.csv:3:3: ") && Contains("0.0001 m apart") && Contains("at least 0.001 m"));
  CHECK(error_of(flight(1, 2, 1, "32000000")) == "accepted");
  CHECK_THAT(
      error_of(flight(1, 2, 1, "40000000")),
      Contains("flight.csv:2:1: throughput_kbps 40000000 means an SINR of 12191 dB") && Contains("sinr_db; add it"));
}

TEST_CASE("unreadable files are named") {
  for (const char* path : {"/nonexistent/flight.csv", "/"}) {
    try {
      static_cast<void>(world::parse_measured_flight(read_file(path), path));
      FAIL("accepted");
    } catch (const InputError& error) {
      CHECK_THAT(error.what(), Contains(path) && Contains("cannot read"));
    }
  }
}
