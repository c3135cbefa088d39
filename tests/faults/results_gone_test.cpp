// The result folder is deleted, moved or replaced while a run writes into it: the run reports it, and nothing is lost.

#include <catch2/catch.hpp>
#include <functional>

#include "tests/faults/fault_scene.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// Starts the run, damages its results halfway, and checks that it stops and leaves no process that could write.
void check_stops(const FaultScene& scene, const std::string& name, const std::vector<std::string>& options,
                 const std::function<void(const fs::path& dir)>& strike, const std::string& what) {
  INFO(name);
  const auto run = scene.start(name, options);
  scene.wait_for_flights(name, *run, scene.flights() / 8);
  REQUIRE(run->running());
  strike(scene.out(name));
  const Finished finished = run->wait(60s);
  INFO(finished.err);
  CHECK(finished.exit_code == 1);
  CHECK_THAT(finished.err, Contains(what) && Contains(scene.out(name).string()) && Contains("the same command"));
  CHECK(processes_with(scene.out(name).string()).empty());
}

void check_goes_on(const FaultScene& scene, const std::string& name, const std::vector<std::string>& options) {
  const Finished finished = run_command(scene.run_arguments(name, options), 120s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(scene.digest(name) == scene.reference());
}

}  // namespace

TEST_CASE("results that are moved, deleted or replaced under a run stop it, and the same command goes on",
          "[storage]") {
  const FaultScene scene(24);
  const std::vector<std::string> over_dds{"--workers", "1"};
  const std::vector<std::string> in_process{"--workers", "1", "--in-process"};
  const fs::path aside = scene.out("aside");

  for (const auto& options : {over_dds, in_process}) {
    const std::string way = options.size() == 2 ? "dds" : "in-process";
    check_stops(
        scene, "moved-" + way, options, [&](const fs::path& dir) { fs::rename(dir, aside); }, "results.sqlite is gone");
    CHECK_FALSE(fs::exists(scene.out("moved-" + way)));  // no process makes a new folder there
    const int stored = scene.stored("aside");
    CHECK(stored >= scene.flights() / 8);
    fs::rename(aside, scene.out("moved-" + way));
    CHECK(scene.stored("moved-" + way) == stored);
    check_goes_on(scene, "moved-" + way, options);
  }

  check_stops(
      scene, "deleted", in_process, [](const fs::path& dir) { fs::remove_all(dir); }, "results.sqlite is gone");
  CHECK_FALSE(fs::exists(scene.out("deleted")));
  check_goes_on(scene, "deleted", in_process);

  check_stops(
      scene, "database", over_dds, [](const fs::path& dir) { fs::remove(dir / "results.sqlite"); },
      "results.sqlite is gone");
  const Finished refused = run_command(scene.run_arguments("database", over_dds));
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("has lost its results.sqlite") && Contains("Put it back, or remove the folder"));

  // Without SQLite's write-ahead log, the flights in it would be lost when the process ends.
  check_stops(
      scene, "log", over_dds, [](const fs::path& dir) { fs::remove(dir / "results.sqlite-wal"); },
      "results.sqlite-wal is gone");
  CHECK(scene.stored("log") >= scene.flights() / 8);
  check_goes_on(scene, "log", over_dds);
}

TEST_CASE("a collector that has nothing to store notices within seconds that its folder is gone", "[storage]") {
  const ScratchDir scratch;
  const std::string out = (scratch / "out").string();
  const std::string run = own_name("gone");
  const std::vector<std::string> where{
      "data/experiments/quick.json", "--run", run, "--out", out, "--domain", test_domain()};
  const auto start = [&](const std::string& command) {
    std::vector<std::string> arguments{"aloft", command};
    arguments.insert(arguments.end(), where.begin(), where.end());
    return std::make_unique<Command>(arguments);
  };
  const auto metrics = start("metrics");
  const auto coordinator = start("coordinator");
  // By then coordinator and collector have found each other.
  CHECK(eventually(30s, [&] { return coordinator->error_so_far().find("no worker for") != std::string::npos; }));
  CHECK(eventually(30s, [&] { return fs::exists(scratch / "out" / "results.sqlite"); }));
  REQUIRE(metrics->running());
  fs::remove_all(out);
  const Finished collected = metrics->wait(20s);
  CHECK(collected.exit_code == 1);
  CHECK_THAT(collected.err, Contains("'" + out + "' was deleted, moved or replaced") && Contains("same command"));
  const Finished coordinated = coordinator->wait(30s);
  CHECK(coordinated.exit_code == 1);
  CHECK_THAT(coordinated.err, Contains("aloft-metrics failed") && Contains("was deleted, moved or replaced"));
  CHECK_FALSE(fs::exists(out));
}
