// aloft compare, as a user sees it.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/integration/command.hpp"

using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::write_text;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// Result folders of one small experiment with different settings.
struct Runs {
  ScratchDir scratch;

  Runs() {
    write_text(scratch / "experiment.json", R"({"name": "small", "seed": 3, "trials": 4,
      "world": {"kind": "generated", "bs_density_per_km2": 5, "building_density_per_km2": 200, "steps": 20},
      "agents": ["min-height", "random-walk", "constant-120"]})");
  }
  [[nodiscard]] std::string run(const std::string& name, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"aloft",        "run",   (scratch / "experiment.json").string(),
                                       "--in-process", "--out", (scratch / name).string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished finished = run_command(arguments);
    INFO(finished.err);
    REQUIRE(finished.exit_code == 0);
    return (scratch / name).string();
  }
};

}  // namespace

TEST_CASE("two runs of one experiment are identical") {
  const Runs runs;
  const std::string a = runs.run("a");
  const std::string b = runs.run("b", {"--workers", "2"});
  const Finished finished = run_command({"aloft", "compare", a, b, "--exact"});
  CHECK(finished.exit_code == 0);
  CHECK_THAT(finished.out,
             Contains("The same experiment") && Contains("12 of 12 flights that both have are identical."));
}

TEST_CASE("two settings: paired differences, the setting and the first step that differ; --exact fails") {
  const Runs runs;
  const std::string a = runs.run("a");
  const std::string b = runs.run("b", {"--set", "world.los_ray=geometric"});
  const Finished text = run_command({"aloft", "compare", a, b});
  CHECK(text.exit_code == 0);
  CHECK_THAT(text.out, Contains("los_ray") && Contains("geometric") && Contains("on the same trials") &&
                           Contains("First difference: condition"));
  const Finished exact = run_command({"aloft", "compare", a, b, "--exact", "--format", "json"});
  CHECK(exact.exit_code == 1);
  const Json document = Json::parse(exact.out);
  CHECK_FALSE(document["same_experiment"].get<bool>());
  CHECK(document["paired"].get<bool>());
  REQUIRE(document["agents"].size() == 3);
  const Json& row = document["agents"][0];
  CHECK(row["flights_in_both"] == 4);
  CHECK(row["qos_difference"].get<double>() ==
        Approx(row["qos_mean_b"].get<double>() - row["qos_mean_a"].get<double>()));
  CHECK(row["qos_difference_ci95"][0].get<double>() <= row["qos_difference"].get<double>());
}

TEST_CASE("runs with different seeds are reported as not paired; runs that share no flights are refused") {
  const Runs runs;
  const std::string a = runs.run("a");
  const std::string b = runs.run("b", {"--seed", "4"});
  CHECK_THAT(run_command({"aloft", "compare", a, b}).out, Contains("Not paired: the seeds differ"));
  const std::string c = runs.run("c", {"--agents", "constant-240"});
  const Finished refused = run_command({"aloft", "compare", a, c});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("constant-240") && Contains("min-height"));
  CHECK(run_command({"aloft", "compare", a, runs.scratch.path().string()}).exit_code == 2);
}
