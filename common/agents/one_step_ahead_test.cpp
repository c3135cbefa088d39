#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;

namespace {

using Table = std::vector<std::vector<double>>;

/// Heights 40, 45, 50, 55, 60 m, one action moves 10 m.
const aloft::radio::HeightGrid half_steps{40, 60, 10, 5};

std::vector<double> heights_flown(const nlohmann::json& entry, SyntheticMap map) {
  const AgentSpec spec = parse_agents(entry, "agents[0]").front();
  std::vector<double> heights_m;
  for (const auto& step : aloft::flight::fly(map, 1, 0, *spec.make(), spec).steps) heights_m.push_back(step.height_m);
  return heights_m;
}

}  // namespace

TEST_CASE("one-step-ahead conforms") {
  aloft::flight::check_conformance({{"type", "one-step-ahead"}, {"target_resolution_m", {0, 10, 20}}});
}

TEST_CASE("one-step-ahead moves towards the best height of the place where its result is read") {
  // clang-format off
  const Table table{
      // 45 and 55 m are not multiples of 10 m above Zmin. Heights flown, with targets in brackets:
      //                  every height   multiples of 10 m
      {0, 0, 0, 0, 99},  // point 0 is never scored
      {5, 0, 1, 0, 9},   // 50 (60)      50 (60), although it is the worst of the three within reach
      {0, 9, 5, 0, 5},   // 40 (45)      50 (50, the lower of equals)
      {7, 0, 0, 0, 7},   // 40 (40)      40 (40, the lower of equals)
      {6, 8, 0, 0, 7},   // 50 (45)      50 (60)
      {7, 9, 6, 0, 0},   // 40 (45)      40 (40)
      {6, 8, 0, 0, 0},   // 50 (45)      40 (40)
  };
  // clang-format on
  const SyntheticMap map(QosKind::spectral_efficiency, half_steps, table);
  CHECK(heights_flown("one-step-ahead", map) == std::vector<double>{50, 40, 40, 50, 40, 50});
  CHECK(heights_flown({{"type", "one-step-ahead"}, {"target_resolution_m", 10}}, map) ==
        std::vector<double>{50, 50, 40, 50, 40, 40});
}

TEST_CASE("one-step-ahead in a measured flight foresees the step that it flies") {
  const aloft::radio::HeightGrid grid{20, 40, 10, 10};
  const SyntheticMap map(QosKind::throughput, grid, {{0, 0, 9}, {9, 0, 0}, {0, 0, 9}, {0, 9, 0}});
  CHECK(heights_flown("one-step-ahead", map) == std::vector<double>{30, 20, 30, 30});
}

TEST_CASE("one-step-ahead throws if it was not shown the next step") {
  const auto agent = parse_agents("one-step-ahead", "agents[0]").front().make();
  agent->begin({.height_min_m = 40, .height_max_m = 80, .height_step_m = 10, .steps = 9});
  agent->observe({.step = 0, .height_m = 40});
  CHECK_THROWS_AS(agent->act(), std::logic_error);
}
