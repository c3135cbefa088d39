#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/flight/testing/conformance.hpp"

using namespace aloft::agents;

TEST_CASE("min-height conforms") {
  aloft::flight::check_conformance("min-height");
}

TEST_CASE("min-height holds at the floor, and returns to it") {
  const auto agent = parse_agents("min-height", "agents[0]").front().make();
  agent->begin({.height_min_m = 40, .height_max_m = 240, .height_step_m = 10, .steps = 9});
  agent->observe({.step = 0, .height_m = 40});
  CHECK(agent->act().action == Action::hold);
  agent->observe({.step = 1, .height_m = 60});
  CHECK(agent->act().action == Action::down);
}
