#include "tools/importer/measurement_grid.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "tests/published_data.hpp"
#include "tools/importer/test_workspace.hpp"

using aloft::InputError;
using aloft::importer::GridOptions;
using aloft::importer::MeasurementGrid;
using aloft::importer::NumericVectors;
using aloft::importer::rebuild_grid;
using aloft::importer::to_csv;
using aloft::importer::test::north_wall_quay_like;
using aloft::importer::test::one_flight_per_level;
using aloft::importer::test::Recorder;
using Catch::Contains;

namespace {

// 5 steps, 2 heights; level 2 was recorded at steps 2 and 4 only.
const Recorder small{5, 2, {10, 21, 11, 22, 12, 30, 13, 24, 14, 25}};
const std::vector<std::vector<std::uint32_t>> small_flights{{1, 2, 1, 1, 1}, {1, 1, 1, 2, 1}, {1, 1, 1, 1, 1}};

NumericVectors changed(const std::string& name, std::size_t index, double value) {
  NumericVectors vectors = small.record(small_flights);
  vectors.at(name).at(index) = value;
  return vectors;
}

std::string refusal(const NumericVectors& vectors, const GridOptions& options = {}) {
  try {
    static_cast<void>(rebuild_grid(vectors, options, "flight.Rdata"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("recorded cells keep their value; others get the nearest recorded step's, at most the step's maximum") {
  const MeasurementGrid grid = rebuild_grid(small.record(small_flights), {}, "flight.Rdata");
  CHECK(grid.steps == 5);
  CHECK(grid.heights == 2);
  CHECK(grid.triples == 6U * 3 * 5);
  CHECK(grid.above_known_maximum == 0);
  // Level 2: step 1 would get step 2's 22, but its maximum is 21; step 3 is as near to 2 as to 4: the earlier one;
  // step 5 gets step 4's 24.
  CHECK(
      to_csv(grid) ==
      "step,height_m,throughput_kbps,observed\n"
      "1,20,10,1\n1,30,21,0\n2,20,11,1\n2,30,22,1\n3,20,12,1\n3,30,22,0\n4,20,13,1\n4,30,24,1\n5,20,14,1\n5,30,24,0\n");
}

TEST_CASE("a flight of 160 steps and 10 heights from 30 m comes back whole") {
  const Recorder recorder = north_wall_quay_like();
  const GridOptions options{30.0, 10.0, {}};
  const MeasurementGrid grid = rebuild_grid(recorder.record(one_flight_per_level(recorder)), options, "nwq.Rdata");
  CHECK(grid.steps == 160);
  CHECK(grid.heights == 10);
  CHECK(grid.throughput_kbps == recorder.truth);
  CHECK(std::count(grid.observed.begin(), grid.observed.end(), true) == 1600);
  const std::string csv = to_csv(grid);
  CHECK_THAT(csv, Contains("\n1,30,20000.5,1\n") && Contains("\n160,120,"));
}

TEST_CASE("noise in the last bit is no conflict; a different value is one and both places are named") {
  CHECK(to_csv(rebuild_grid(changed("achieveableRate", 3, 13.000000000000002), {}, "")) ==
        to_csv(rebuild_grid(small.record(small_flights), {}, "")));
  // Value 9 of the learner is step 4 of its second flight, at level 2.
  CHECK_THAT(refusal(changed("achieveableRate", 8, 24.5)),
             Contains("flight.Rdata") && Contains("step 4, height 30 m") &&
                 Contains("constAchieveableRate[9] is 24 ") && Contains("achieveableRate[9] is 24.5"));
}

TEST_CASE("vectors that are missing, of odd length or with impossible values are refused by name") {
  NumericVectors vectors = small.record(small_flights);
  vectors.erase("randheight");
  vectors.erase("optmAchieveableRate");
  CHECK_THAT(refusal(vectors), Contains("randheight, optmAchieveableRate") && Contains("const1height"));
  CHECK_THAT(refusal({}), Contains("no numeric vectors"));

  vectors = small.record(small_flights);
  vectors.at("maxheight").pop_back();
  CHECK_THAT(refusal(vectors), Contains("maxAchieveableRate has 15") && Contains("maxheight has 14"));

  CHECK_THAT(refusal(changed("randheight", 2, 1.5)), Contains("randheight[3] is 1.5"));
  CHECK_THAT(refusal(changed("randheight", 2, 0)), Contains("randheight[3] is 0"));
  CHECK_THAT(refusal(changed("randheight", 2, 1e9)), Contains("1000"));
  CHECK_THAT(refusal(changed("const2AchieveableRate", 0, -1)), Contains("const2AchieveableRate[1] is -1"));
  CHECK_THAT(refusal(changed("optmAchieveableRate", 0, std::nan(""))), Contains("optmAchieveableRate[1] is nan"));
  CHECK_THAT(refusal(changed("height", 0, 4)), Contains("level 3") && Contains("40 m"));
}

TEST_CASE("the number of steps is detected, or given and checked") {
  GridOptions options;
  options.steps = 5;
  CHECK(rebuild_grid(small.record(small_flights), options, "").steps == 5);
  options.steps = 4;
  CHECK_THAT(refusal(small.record(small_flights), options), Contains("--steps") && Contains("optmAchieveableRate 18"));
  options.steps = 0;
  CHECK_THAT(refusal(small.record(small_flights), options), Contains("--steps"));
  NumericVectors vectors = small.record(small_flights);
  vectors.at("optmAchieveableRate").resize(7);
  CHECK_THAT(refusal(vectors), Contains("--steps N") && Contains("constAchieveableRate 15"));
}

TEST_CASE("heights out of range are refused") {
  const NumericVectors vectors = small.record(small_flights);
  CHECK_THAT(refusal(vectors, {20.0, 0.0, {}}), Contains("--height-step"));
  CHECK_THAT(refusal(vectors, {20.0, std::nan(""), {}}), Contains("--height-step"));
  CHECK_THAT(refusal(vectors, {-1.0, 10.0, {}}), Contains("--height-min"));
}

TEST_CASE("a recorded value above the step's known maximum is kept and counted") {
  NumericVectors vectors = small.record(small_flights);
  vectors.at("optmAchieveableRate").at(1) = 21.5;
  const MeasurementGrid grid = rebuild_grid(vectors, {}, "");
  CHECK(grid.above_known_maximum == 1);
  CHECK(grid.throughput_kbps[3] == 22.0);
}

TEST_CASE("the authors' Grand Canal Quay workspace gives the measurement grid byte for byte", "[needs-gcq]") {
  const auto workspace = aloft::test::published_file("Real_canal_tudo1.Rdata");
  const auto csv = aloft::test::published_file("gcq.csv");
  if (workspace.empty() || csv.empty()) return;
  const MeasurementGrid grid = rebuild_grid(aloft::importer::read_r_workspace(workspace), {}, "Real_canal_tudo1.Rdata");
  CHECK(grid.steps == 170);
  CHECK(grid.heights == 11);
  CHECK(std::count(grid.observed.begin(), grid.observed.end(), true) == 1803);
  CHECK(grid.above_known_maximum == 0);
  std::ostringstream expected;
  expected << std::ifstream(csv).rdbuf();
  CHECK((to_csv(grid) == expected.str()));
}
