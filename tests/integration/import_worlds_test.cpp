// aloft import-scatter and aloft import-map, as a user sees them: the samples of the package become worlds that agents
// fly over; what cannot be used is refused, and nothing is written.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tools/importer/test_npz.hpp"

using namespace aloft::test;
using Catch::Contains;
using Json = nlohmann::json;
namespace numpy = aloft::importer::test;

namespace {

std::string sample(const std::string& name) {
  return (source_dir() / "data/samples" / name).string();
}

using Options = std::vector<std::string>;

Finished import(const std::string& command, const std::string& file, const ScratchDir& scratch,
                const Options& options) {
  Options arguments{"aloft", command, file, "--out", (scratch / "grid.csv").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_command(arguments);
}

const Options scatter_columns{"--altitude", "altitude_m", "--sinr", "sinr_db",  "--cell",
                              "cell",       "--time",     "time",   "--ground", "4"};
const Options map_route{"--route", "20,20", "380,20", "380,180"};

std::size_t files_in(const ScratchDir& scratch) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(scratch.path()), {}));
}

/// Flies these agents over the imported world, in process.
Finished fly(const ScratchDir& scratch, const std::string& agents) {
  write_text(scratch / "flight.json", R"({"name": "flight", "trials": 2, "world": {"kind": "measured", "file": ")" +
                                          (scratch / "grid.csv").string() + R"("}, "agents": [)" + agents + "]}");
  return run_command(
      {"aloft", "run", (scratch / "flight.json").string(), "--in-process", "--out", (scratch / "out").string()});
}

}  // namespace

TEST_CASE("the sample of measurements becomes a world that agents fly over") {
  const ScratchDir scratch;
  const Finished finished = import("import-scatter", sample("scatter_sample.csv"), scratch, scatter_columns);
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(finished.out,
             Contains("41 steps x 5 heights, 20 to 60 m; 201 of 205 values have samples") &&
                 Contains("held out, at least 2 s apart: 245 of 245 samples predicted, rms error 1.071 dB") &&
                 Contains("cell 11: 45 of 45"));
  const std::string csv = read_text(scratch / "grid.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 206);
  const Json facts = Json::parse(read_text(scratch / "grid.import.json"));
  CHECK(facts["held_out"]["rms_error"] == 1.071);
  CHECK(facts["held_out"]["cells"].size() == 3);
  CHECK(facts["observed"] == 201);
  CHECK(facts["file_sha256"].get<std::string>().size() == 64);

  const Finished flown = fly(scratch, R"("min-height", "planner", "local-bandit", "height-filter")");
  INFO(flown.err);
  CHECK(flown.exit_code == 0);
  const Json summary = Json::parse(read_text(scratch / "out" / "summary.json"));
  CHECK(summary.dump().find("planner") != std::string::npos);
}

TEST_CASE("the sample of a radio map becomes a world with base stations, for agents with the site map, too") {
  const ScratchDir scratch;
  const Finished finished = import("import-map", sample("map_sample.npz"), scratch, map_route);
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("53 steps x 7 heights, 20 to 80 m; 3 cells") && Contains("grid.sites.csv"));
  CHECK(Json::parse(read_text(scratch / "grid.import.json"))["cells"] == 3);
  const Finished flown = fly(scratch, R"("min-height", "planner", "site-planner")");
  INFO(flown.err);
  CHECK(flown.exit_code == 0);
}

TEST_CASE("imports replace nothing without --force, the imported file never, and leave nothing of a failure") {
  const ScratchDir scratch;
  REQUIRE(import("import-map", sample("map_sample.npz"), scratch, map_route).exit_code == 0);
  std::filesystem::remove(scratch / "grid.csv");
  const Finished refused = import("import-map", sample("map_sample.npz"), scratch, map_route);
  CHECK(refused.exit_code == 2);  // its sites and its facts are still there
  CHECK_THAT(refused.err, Contains("grid.import.json is already there") && Contains("--force"));
  Options forced = map_route;
  forced.emplace_back("--force");
  CHECK(import("import-map", sample("map_sample.npz"), scratch, forced).exit_code == 0);
  write_text(scratch / "map.npz", numpy::npz(numpy::small_map()));
  CHECK(std::filesystem::exists(scratch / "grid.sites.csv"));
  CHECK(
      import("import-map", (scratch / "map.npz").string(), scratch, {"--route", "0,5", "20,5", "--force"}).exit_code ==
      0);
  CHECK_FALSE(std::filesystem::exists(scratch / "grid.sites.csv"));  // this map has none
  const std::string csv = read_text(scratch / "grid.csv");
  CHECK(
      import("import-scatter", (scratch / "grid.csv").string(), scratch, {"--sinr", "sinr_db", "--force"}).exit_code ==
      2);
  CHECK(read_text(scratch / "grid.csv") == csv);
}

TEST_CASE("measurements and maps that cannot be used end with code 2 and what is wrong, and write nothing") {
  const auto refused = [](const std::string& command, const std::string& content, const Options& options) {
    const ScratchDir scratch;
    write_text(scratch / "input", content);
    const Finished finished = import(command, (scratch / "input").string(), scratch, options);
    CHECK(finished.exit_code == 2);
    CHECK(finished.out.empty());
    CHECK(files_in(scratch) == 1);
    return finished.err;
  };
  const std::string header = "latitude,longitude,altitude,rsrp\n";
  const Options rsrp{"--rsrp", "rsrp"};
  CHECK_THAT(refused("import-scatter", header + "0,0,20,-80\n", {"--rsrp", "rsrpp"}),
             Contains("input:1:1: the header has no column 'rsrpp'") && Contains("Did you mean 'rsrp'"));
  CHECK_THAT(refused("import-scatter", header + "0,0,20,nan\n", rsrp), Contains("input:2:8: rsrp is 'nan'"));
  CHECK_THAT(refused("import-scatter", header + "0,0,20,-80\n", rsrp), Contains("--height-min"));
  CHECK_THAT(refused("import-scatter", header + "0,0,20,-80\n0,0,30,-80\n", {"--rsrp", "rsrp", "--height-max", "40"}),
             Contains("a hole at step 1") && Contains("40 m"));
  CHECK_THAT(refused("import-scatter", header, {}), Contains("--rsrp") && Contains("--throughput"));
  CHECK_THAT(refused("import-scatter", header, {"--rsrp", "rsrp", "--radius", "0"}), Contains("--radius"));

  const Options route{"--route", "0,5", "20,5"};
  CHECK_THAT(refused("import-map", "no map", route), Contains("no NPZ file"));
  CHECK_THAT(refused("import-map", numpy::npz(numpy::small_map()), {"--route", "0,5", "30,5"}),
             Contains("x = 30 m leaves the map, which has x from 0 to 20 m"));
  CHECK_THAT(refused("import-map", numpy::npz(numpy::small_map()), {"--route", "0,5", "--height-max", "50"}),
             Contains("z = 40 m leaves the map, which has z from 20 to 30 m"));
  CHECK_THAT(refused("import-map", numpy::npz(numpy::small_map()), {"--route", "0;5"}), Contains("--route 0;5"));
  CHECK_THAT(refused("import-map", numpy::npz(numpy::small_map()), {"--route", "0,5", "--origin", "95,0"}),
             Contains("--origin 95,0"));
}
