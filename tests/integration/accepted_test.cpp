// Experiments that `aloft validate` accepts fly in process and over DDS, with the same bytes.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <random>

#include "common/base/limits.hpp"
#include "tests/faults/effort.hpp"
#include "tests/integration/command.hpp"
#include "tests/limits/random_experiment.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

/// False if it is refused.
bool flies(const nlohmann::json& experiment, const ScratchDir& scratch) {
  const std::string name = experiment.at("name");
  const std::string file = (scratch / (name + ".json")).string();
  write_text(file, experiment.dump(2));
  INFO(experiment.dump(2));
  const Finished checked = run_command({"aloft", "validate", file});
  if (checked.exit_code == 2) return false;
  CHECK(checked.exit_code == 0);
  const auto fly = [&](const std::string& where, const std::vector<std::string>& options) {
    const std::string out = (scratch / (name + where)).string();
    std::vector<std::string> arguments{"aloft", "run", file, "--out", out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished finished = run_command(arguments, 120s);
    INFO(where << ": " << finished.err);
    CHECK(finished.exit_code == 0);
    return run_command({"aloft", "digest", out}).out;
  };
  const std::string digest = fly("-in-process", {"--in-process"});
  CHECK(digest.size() == 65);
  CHECK(fly("-dds", {"--workers", "1", "--domain", test_domain()}) == digest);
  return true;
}

}  // namespace

TEST_CASE("random experiments that are accepted fly in process and over DDS with the same bytes") {
  const ScratchDir scratch;
  const std::uint64_t first = std::random_device()();
  int flown = 0;
  for (std::uint64_t seed = first; flown < effort(3, 100); ++seed) {
    INFO("seed " << seed);
    REQUIRE(seed < first + 30 * effort(3, 100));
    if (flies(random_experiment(seed, scratch.path(), true).json, scratch)) ++flown;
  }
}

TEST_CASE("flights that networks hand over have the same bytes in process and over DDS") {
  const ScratchDir scratch;
  const auto crew = nlohmann::json::array(
      {{{"agent", "random-walk"}, {"shadow", true}}, {{"agent", "height-filter"}, {"from_step", 9}, {"shadow", true}}});
  const nlohmann::json dqn{{"type", "dqn"}, {"epochs", 3}};
  const nlohmann::json relay{{"type", "relay"}, {"name", "crew"}, {"crew", crew}};
  CHECK(flies({{"name", "handed-over"},
               {"trials", 2},
               {"handover_cost", 0.5},
               {"handover_loss", 0.5},
               {"world", {{"serving", "a3"}, {"bs_density_per_km2", 5}, {"steps", 20}}},
               {"agents", {"random-walk", "planner", dqn, relay}}},
              scratch));
}

TEST_CASE("experiments at the limits fly in process and over DDS with the same bytes") {
  const ScratchDir scratch;
  const std::string csv = (scratch / "flight.csv").string();
  const int steps = effort(10, limits::steps);
  const int heights = effort(1000, limits::cells / limits::steps);
  {
    std::ofstream flight(csv);
    flight << "step,height_m,throughput_kbps\n";
    for (int step = 1; step <= steps; ++step)
      for (int level = 0; level < heights; ++level)
        flight << fmt::format("{},{},{}\n", step, 9'000 + 0.001 * level,
                              (step * 7 + level * 13) % 97 == 0 ? 32'000'000 : 10 * ((step * level) % 5'000));
  }
  const nlohmann::json measured{{"kind", "measured"}, {"file", csv}};
  const nlohmann::json highest{{"steps", 3},
                               {"route_spacing_m", 1000},
                               {"height_min_m", 30},
                               {"height_max_m", 30 + limits::heights - 1},
                               {"height_step_m", 1},
                               {"bs_density_per_km2", 1},
                               {"building_density_per_km2", 0.1},
                               {"route_start_x_m", -1500}};
  CHECK(flies({{"name", "limits"},
               {"seed", UINT64_MAX},
               {"trials", 1},
               {"speed_m_per_s", 1},
               {"energy_weight", 10'000},
               {"handover_cost", 1'000'000},
               {"worlds", {measured, highest}},
               {"agents", {"min-height", "planner", "optimal-height"}}},
              scratch));
}
