// A second collector or coordinator beside a whole run of `aloft run`.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <thread>

#include "tests/faults/fault_scene.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("a second collector beside a run, while the run's own stands still, takes no flight away", "[doubles]") {
  const FaultScene scene(20);
  const std::string name = own_name("two");
  const auto run = scene.start("d1", {"--workers", "2", "--run", name});
  scene.wait_for_flights("d1", *run, 5);
  const int own = scene.services("d1", *run, "aloft-metrics").at(0);
  kill(own, SIGSTOP);
  Command second({"aloft", "metrics", scene.experiment().string(), "--run", name, "--domain", test_domain(), "--out",
                  scene.out("d2").string()});
  std::this_thread::sleep_for(4s);
  const Finished refused = second.wait();
  kill(own, SIGCONT);
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err,
             Contains("aloft-metrics on host") && Contains(fmt::format("(process {},", own)) && Contains("is refused"));
  CHECK(scene.stored("d2") == 0);
  scene.check_finished("d1", *run, 120s);
}

TEST_CASE("the second of two runs of one name ends at once, names the first, and leaves nothing", "[doubles]") {
  const FaultScene scene(24);
  const std::string name = own_name("same");
  std::vector<std::unique_ptr<Command>> runs;
  const std::vector<std::string> folders{"first", "second", "third"};
  for (const std::string& folder : {folders[0], folders[1]})  // both at the same time
    runs.push_back(scene.start(folder, {"--workers", "2", "--run", name}));
  CHECK(eventually(60s, [&] { return scene.stored(folders[0]) + scene.stored(folders[1]) > 0; }));
  const std::size_t winner = scene.stored(folders[0]) > 0 ? 0 : 1;
  Command& run = *runs[winner];
  const auto learners = [&](int signal) {  // the run cannot end without them
    for (const int pid : scene.services(folders[winner], run, "aloft-learning-agent")) kill(pid, signal);
  };
  learners(SIGSTOP);
  runs.push_back(scene.start(folders[2], {"--workers", "2", "--run", name}));  // and a third one later
  const std::string coordinator =
      fmt::format("(process {},", scene.services(folders[winner], run, "aloft-coordinator").at(0));
  for (const std::size_t loser : {1 - winner, std::size_t{2}}) {
    const Finished refused = runs[loser]->wait();
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("run '" + name + "' has a coordinator already: aloft-coordinator on host") &&
                                Contains(coordinator) && Contains("aloft worker --join " + name));
    CHECK_FALSE(fs::exists(scene.out(folders[loser])));
  }
  learners(SIGCONT);
  scene.check_finished(folders[winner], run, 120s);
}

TEST_CASE("aloft run counts the stored flights itself when a coordinator reports success", "[doubles]") {
  const ScratchDir scratch;
  const fs::path bin = scratch / "bin";
  fs::create_directories(bin);
  fs::copy_file(bin_dir() / "aloft", bin / "aloft");
  for (const char* program : {"aloft-coordinator", "aloft-metrics", "aloft-environment", "aloft-channel",
                              "aloft-learning-agent", "aloft-baseline-agent"}) {
    // A coordinator that reports success at once, and other programs that do nothing.
    const bool decides = std::string(program) == "aloft-coordinator";
    write_text(bin / program, decides ? "#!/bin/sh\nexit 0\n" : "#!/bin/sh\nexec sleep 60\n");
    fs::permissions(bin / program, fs::perms::owner_all);
  }
  write_text(scratch / "experiment.json", R"({"name": "empty", "trials": 2, "agents": ["min-height", "random-walk"],
    "world": {"kind": "generated", "bs_density_per_km2": 1, "steps": 5}})");
  const Finished finished = run_command({(bin / "aloft").string(), "run", (scratch / "experiment.json").string(),
                                         "--out", (scratch / "out").string(), "--workers", "1"});
  CHECK(finished.exit_code == 1);
  CHECK_THAT(finished.err, Contains("4 of 4 flights are missing: agent min-height in trial 0 of condition 0"));
}
