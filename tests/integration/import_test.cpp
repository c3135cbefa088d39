// aloft import-rdata, as a user sees it: it makes a measured world from an R workspace, or refuses and writes nothing.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/published_data.hpp"
#include "tools/importer/test_workspace.hpp"

using aloft::test::Finished;
using aloft::test::published_file;
using aloft::test::read_text;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::write_text;
using Catch::Contains;
namespace workspace = aloft::importer::test;

namespace {

/// A workspace like that of the North Wall Quay flight: 160 steps, 30 to 120 m.
std::string north_wall_quay() {
  const workspace::Recorder recorder = workspace::north_wall_quay_like();
  return workspace::gzip(
      workspace::xdr_workspace(workspace::objects(recorder.record(workspace::one_flight_per_level(recorder)))));
}

Finished import(const ScratchDir& scratch, const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments{"aloft", "import-rdata", (scratch / "flight.Rdata").string(), "--out",
                                     (scratch / "grid.csv").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_command(arguments);
}

}  // namespace

TEST_CASE("a flight of 160 steps from 30 to 120 m is imported, and can be flown") {
  const ScratchDir scratch;
  workspace::write_bytes(scratch / "flight.Rdata", north_wall_quay());
  const Finished finished = import(scratch, {"--height-min", "30"});
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("160 steps x 10 heights, 30 to 120 m") && Contains("1600 of 1600"));
  const std::string csv = read_text(scratch / "grid.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1601);
  CHECK_THAT(csv, Catch::StartsWith("step,height_m,throughput_kbps,observed\n1,30,20000.5,1\n"));

  write_text(scratch / "flight.json", R"({"name": "flight", "trials": 1, "world": {"kind": "measured", "file": ")" +
                                          (scratch / "grid.csv").string() + R"("}, "agents": ["min-height"]})");
  const Finished flown = run_command(
      {"aloft", "run", (scratch / "flight.json").string(), "--in-process", "--out", (scratch / "out").string()});
  INFO(flown.err);
  CHECK(flown.exit_code == 0);
}

TEST_CASE("an existing file is replaced only with --force, the workspace itself never") {
  const ScratchDir scratch;
  workspace::write_bytes(scratch / "flight.Rdata", north_wall_quay());
  write_text(scratch / "grid.csv", "mine");
  const Finished refused = import(scratch);
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("grid.csv") && Contains("--force"));
  CHECK(read_text(scratch / "grid.csv") == "mine");
  CHECK(import(scratch, {"--force"}).exit_code == 0);
  CHECK(read_text(scratch / "grid.csv").size() > 1600);

  const std::string file = (scratch / "flight.Rdata").string();
  CHECK(run_command({"aloft", "import-rdata", file, "--out", file, "--force"}).exit_code == 2);
  CHECK(read_text(scratch / "flight.Rdata") == north_wall_quay());
  const Finished nowhere =
      run_command({"aloft", "import-rdata", file, "--out", (scratch / "no" / "grid.csv").string()});
  CHECK(nowhere.exit_code == 2);
  CHECK_THAT(nowhere.err, Contains("no folder"));
}

TEST_CASE("a workspace that cannot be imported is refused with a remedy, and nothing is written") {
  const ScratchDir scratch;
  const auto refused = [&](const std::string& bytes, const std::vector<std::string>& options = {}) {
    workspace::write_bytes(scratch / "flight.Rdata", bytes);
    const Finished finished = import(scratch, options);
    CHECK(finished.exit_code == 2);
    CHECK(finished.out.empty());
    CHECK(std::distance(std::filesystem::directory_iterator(scratch.path()), {}) == 1);
    return finished.err;
  };
  const std::string whole = north_wall_quay();
  CHECK_THAT(refused("step,height_m\n"), Contains("not a gzip file"));
  CHECK_THAT(refused(whole.substr(0, whole.size() / 2)), Contains("download it again"));
  CHECK_THAT(refused(workspace::gzip(workspace::xdr_workspace({{"height", std::vector<double>{1.0}}}))),
             Contains("achieveableRate") && Contains("it has height"));
  CHECK_THAT(refused(whole, {"--steps", "150"}), Contains("--steps"));
  CHECK_THAT(refused(whole, {"--height-step", "0"}), Contains("--height-step"));
}

TEST_CASE("the authors' Grand Canal Quay workspace gives the measurement grid byte for byte, from the command line",
          "[needs-gcq]") {
  const auto workspace = published_file("Real_canal_tudo1.Rdata");
  const auto grid = published_file("gcq.csv");
  if (workspace.empty() || grid.empty()) return;
  const ScratchDir scratch;
  const Finished finished =
      run_command({"aloft", "import-rdata", workspace.string(), "--out", (scratch / "gcq.csv").string()});
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("170 steps x 11 heights, 20 to 120 m") && Contains("1803 of 1870"));
  CHECK((read_text(scratch / "gcq.csv") == read_text(grid)));
}
