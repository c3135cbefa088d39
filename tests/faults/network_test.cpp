// A network that loses, repeats, reorders and delays (ALOFT_TEST_FAULTS): the same bytes as in one process.
#include <catch2/catch.hpp>

#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;

TEST_CASE("a bad network costs time, but no byte", "[network]") {
  const FaultScene scene(effort(4, 16));
  std::vector<std::string> networks{
      "data=30",      "data_frag=30",
      "heartbeat=30", "acknack=30",
      "gap=30",       "data=5,data_frag=5,heartbeat=5,acknack=5,gap=5",
      "any=10",       "duplicate=30",
      "delay=50",     "delay=5,delay_ms=2000,duplicate=5",
  };
  if (soak())
    networks.insert(networks.end(), {"data=10", "heartbeat=10", "acknack=10", "any=20", "any=5,duplicate=20,delay=20",
                                     "delay=100,delay_ms=100", "delay=20,delay_ms=2000"});
  for (const std::string& network : networks) {
    INFO(network);
    const Variable faults("ALOFT_TEST_FAULTS", network);
    const auto run = scene.start(network, {"--workers", "2"});
    scene.check_finished(network, *run, 240s);
  }
}

TEST_CASE("a test network that makes no sense is refused", "[network]") {
  const FaultScene scene(1);
  for (const char* wrong : {"data", "data=", "data=101", "data=-1", "delay_ms=1e3", "losses=5", "data=5;gap=5"}) {
    INFO(wrong);
    const Variable faults("ALOFT_TEST_FAULTS", wrong);
    const Finished finished = run_command({"aloft-coordinator", "--results", scene.out("x").string(), "--experiment",
                                           (scene.out("reference") / "experiment.json").string()});
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Catch::Matchers::Contains("ALOFT_TEST_FAULTS"));
  }
}
