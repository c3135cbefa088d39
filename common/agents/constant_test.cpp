#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/flight/testing/conformance.hpp"

using namespace aloft::agents;

TEST_CASE("constant conforms") {
  aloft::flight::check_conformance({{"type", "constant"}, {"height_m", {60, 120, 1000}}});
}

TEST_CASE("constant climbs or descends to the level nearest to its height") {
  const auto command_at = [](const char* name, double height_m) {
    const auto agent = parse_agents(name, "agents[0]").front().make();
    agent->begin({.height_min_m = 40, .height_max_m = 80, .height_step_m = 10, .steps = 9});
    agent->observe({.step = 1, .height_m = height_m});
    return agent->act().action;
  };
  CHECK(command_at("constant-60", 40) == Action::up);
  CHECK(command_at("constant-60", 50) == Action::up);
  CHECK(command_at("constant-60", 60) == Action::hold);
  CHECK(command_at("constant-60", 70) == Action::down);
  CHECK(command_at("constant-64", 60) == Action::hold);
  CHECK(command_at("constant-66", 60) == Action::up);
  CHECK(command_at("constant-66", 70) == Action::hold);
  CHECK(command_at("constant-120", 70) == Action::up);
  CHECK(command_at("constant-120", 80) == Action::hold);  // clamped to Zmax
  CHECK(command_at("constant-10", 40) == Action::hold);   // clamped to Zmin
}
