#include <array>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/flight/testing/conformance.hpp"

using namespace aloft::agents;

namespace {

std::vector<Action> walk(std::uint64_t seed, std::uint32_t trial, std::uint32_t steps) {
  const auto agent = parse_agents("random-walk", "agents[0]").front().make();
  agent->begin(
      {.height_min_m = 40, .height_max_m = 80, .height_step_m = 10, .steps = steps, .seed = seed, .trial = trial});
  std::vector<Action> actions;
  for (std::uint32_t step = 0; step < steps; ++step) {
    agent->observe({.step = step, .height_m = 40});
    actions.push_back(agent->act().action);
  }
  return actions;
}

}  // namespace

TEST_CASE("random-walk conforms") {
  aloft::flight::check_conformance("random-walk");
}

TEST_CASE("random-walk takes each action in a third of the steps") {
  std::array<int, 5> count{};
  for (const Action action : walk(1, 0, 30'000)) ++count.at(static_cast<std::size_t>(action));
  // The standard deviation is sqrt(30000 * 1/3 * 2/3) = 82; five of them.
  for (const Action action : {Action::down, Action::hold, Action::up})
    CHECK(std::abs(count.at(static_cast<std::size_t>(action)) - 10'000) < 410);
}

TEST_CASE("random-walk differs between trials and between seeds") {
  CHECK(walk(1, 0, 50) != walk(1, 1, 50));
  CHECK(walk(1, 0, 50) != walk(2, 0, 50));
}
