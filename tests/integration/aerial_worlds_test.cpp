// Experiments over the channels of 3GPP TR 36.777.
#include <catch2/catch.hpp>

#include "common/base/write_file.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using Catch::Contains;

namespace {

constexpr const char* experiment = R"({
  "name": "aerial", "trials": 2,
  "world": {"propagation": ["uma-av", "umi-av", "rma-av"], "steps": 10, "height_resolution_m": 10},
  "agents": ["min-height", "random-walk", "site-planner", "planner"]
})";

}  // namespace

TEST_CASE("flights over the channels of TR 36.777 have the same bytes with one and with two workers") {
  const ScratchDir scratch;
  aloft::write_file(scratch / "aerial.json", experiment);
  std::vector<std::string> digests;
  for (const char* workers : {"1", "2"}) {
    const std::string out = (scratch / workers).string();
    const Finished run = run_command(
        {"aloft", "run", (scratch / "aerial.json").string(), "--in-process", "--workers", workers, "--out", out});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    digests.push_back(run_command({"aloft", "digest", out}).out);
  }
  CHECK(digests[0].size() == 65);
  CHECK(digests[0] == digests[1]);
}

TEST_CASE("an experiment outside the range of TR 36.777 is refused with the range") {
  const ScratchDir scratch;
  aloft::write_file(scratch / "aerial.json", experiment);
  for (const auto& [setting, range] :
       {std::pair{"world.carrier_ghz=40", "0.7 to 30 GHz"}, std::pair{"world.height_max_m=340", "300 m"},
        std::pair{"world.window_m=6000", "4000 m"}}) {
    const Finished refused = run_command({"aloft", "validate", (scratch / "aerial.json").string(), "--set", setting});
    CHECK(refused.exit_code == 2);
    CHECK(refused.out.empty());
    CHECK_THAT(refused.err, Contains(range));
  }
}
