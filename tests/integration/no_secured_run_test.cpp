// On a middleware with which runs cannot be secured, --secure is refused before anything is started or written.
#include <catch2/catch.hpp>
#include <filesystem>

#include "common/bus/participant.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::test;
using Catch::Contains;

TEST_CASE("--secure is refused, with the reason and what to use instead") {
  const ScratchDir scratch;
  const std::string keys = (scratch / "keys").string();
  REQUIRE(run_command({"aloft", "keys", "init", keys}).exit_code == 0);
  REQUIRE(run_command({"aloft", "keys", "issue", keys, "all"}).exit_code == 0);
  const std::string out = (scratch / "out").string();
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"aloft", "run", "data/experiments/quick.json", "--out", out},
                                             {"aloft", "worker", "--join", "lab"},
                                             {"aloft", "status"},
                                             {"aloft", "doctor"},
                                             {"aloft-channel", "--run", "lab", "--worker", "w0"}}) {
    std::vector<std::string> secured = command;
    secured.insert(secured.end(), {"--secure", keys});
    const Finished finished = run_command(secured);
    INFO(command.back() << ": " << finished.err);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("--secure: a run cannot be secured on " + bus::middleware()) &&
                                 Contains("use Debian 12 (Fast DDS 2.9)"));
    CHECK_FALSE(std::filesystem::exists(out));
  }

  bus::BusOptions place;
  place.secure = keys;
  CHECK_THROWS_WITH(bus::Participant(place), Contains("a run cannot be secured on " + bus::middleware()));
}
