#include "python/src/fleet.hpp"

#include <catch2/catch.hpp>
#include <memory>
#include <stdexcept>

#include "common/agents/registry.hpp"
#include "common/base/error.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/store/result_store.hpp"

namespace aloft::python {
namespace {

using Catch::Contains;

constexpr const char* city =
    R"({"bs_density_per_km2": [1, 5], "building_density_per_km2": 50, "height_resolution_m": 10})";

std::shared_ptr<const Worlds> worlds(const char* json = city) {
  return std::make_shared<Worlds>(std::string_view(json), Choices{});
}

void begin(Fleet& fleet, std::uint64_t first_seed) {
  std::vector<Start> starts(fleet.size());
  for (std::uint32_t i = 0; i < fleet.size(); ++i) starts[i] = {first_seed + i, i, i % 2};
  fleet.reset(starts, std::vector<std::uint8_t>(fleet.size(), 1));
}

std::int64_t action_of(std::uint32_t step, std::uint32_t index) {
  return (step / 7 + index) % 3;
}

void step(Fleet& fleet, std::uint32_t number) {
  std::vector<std::int64_t> actions(fleet.size());
  for (std::uint32_t i = 0; i < fleet.size(); ++i) actions[i] = action_of(number, i);
  fleet.step(actions);
}

/// Flies two environments, and the same flights by themselves.
void check_traces(const char* json) {
  const auto shared = worlds(json);
  Fleet fleet(shared, {.environments = 2, .threads = 1});
  begin(fleet, 7);
  for (std::uint32_t number = 0; fleet.columns().flag[Fleet::terminated * 2] == 0; ++number) step(fleet, number);
  for (std::uint32_t i = 0; i < 2; ++i) {
    const auto map = shared->map(i, 7 + i, i);
    flight::Flight flight(*map, 7 + i, i, shared->costs(i));
    for (std::uint32_t number = 0; !flight.finished(); ++number)
      flight.step({.action = static_cast<agents::Action>(1 + action_of(number, i))}, "me");
    CHECK(fleet.look(i, [](const Environment& one) { return one.trace("me"); }) ==
          store::encode_trace(flight.record()));
  }
}

}  // namespace

TEST_CASE("a flight has the trace of the flight that fly() gives for the same commands") {
  check_traces(city);
  check_traces(R"({"bs_density_per_km2": 5, "serving": ["strongest", "a3"], "height_resolution_m": 10})");
}

TEST_CASE("any number of threads gives the same columns, over the ends of flights") {
  for (const Autoreset autoreset : {Autoreset::next_step, Autoreset::same_step}) {
    Fleet alone(worlds(), {.layout = {.history = 2}, .autoreset = autoreset, .environments = 9, .threads = 1});
    Fleet team(worlds(), {.layout = {.history = 2}, .autoreset = autoreset, .environments = 9, .threads = 4});
    begin(alone, 1);
    begin(team, 1);
    std::uint32_t ended = 0;
    for (std::uint32_t number = 0; number < 120; ++number) {
      step(alone, number);
      step(team, number);
      ended += alone.columns().flag[Fleet::terminated * 9];
      REQUIRE(team.columns().observation == alone.columns().observation);
      REQUIRE(team.columns().final_observation == alone.columns().final_observation);
      REQUIRE(team.columns().number == alone.columns().number);
      REQUIRE(team.columns().integer == alone.columns().integer);
      REQUIRE(team.columns().flag == alone.columns().flag);
    }
    CHECK(ended > 0);
  }
}

TEST_CASE("what cannot be done is refused before anything moves") {
  Fleet fleet(worlds(), {.environments = 2, .threads = 1});
  CHECK_THROWS_WITH(step(fleet, 0), Contains("call reset() first"));
  begin(fleet, 1);
  const std::vector<float> before = fleet.columns().observation;
  CHECK_THROWS_WITH(fleet.step(std::vector<std::int64_t>{1, 3}), Contains("3 is not allowed; use 0 (down)"));
  CHECK_THROWS_AS(fleet.step(std::vector<std::int64_t>{1, -1}), InputError);
  CHECK_THROWS_AS(fleet.step(std::vector<std::int64_t>{1}), InputError);
  CHECK(fleet.columns().observation == before);
  CHECK(fleet.look(0, [](const Environment& one) { return one.flight().observation().step; }) == 0);
  CHECK_THROWS_WITH(fleet.reset(std::vector<Start>{{1, 0, 0}, {1, 0, 2}}, std::vector<std::uint8_t>{1, 1}),
                    Contains("use a whole number from 0 to 1"));
  for (std::uint32_t number = 0; fleet.columns().flag[Fleet::terminated * 2] == 0; ++number) step(fleet, number);
  CHECK_THROWS_WITH(step(fleet, 0), Contains("call reset() before the next step()"));
  CHECK_THROWS_WITH(Fleet(worlds(), {.environments = 0}), Contains("num_envs: 0 is not allowed"));
  CHECK_THROWS_WITH(Fleet(worlds(), {.layout = {.history = 1'000}, .environments = 60'000}), Contains("too large"));
}

TEST_CASE("a failing environment leaves the others alone, and can begin again") {
  // The route rule is checked with the experiment, so that only a number of trials is left to fail at an end.
  Fleet fleet(worlds(), {.autoreset = Autoreset::same_step, .environments = 3, .threads = 2});
  const std::uint32_t last = 0xFFFFFFFFU;
  fleet.reset(std::vector<Start>{{1, 0, 0}, {1, last, 0}, {1, 2, 0}}, std::vector<std::uint8_t>{1, 1, 1});
  const auto steps = fleet.columns().integer[Fleet::steps * 3];
  for (std::int64_t number = 1; number < steps; ++number) step(fleet, 0);
  CHECK_THROWS_WITH(step(fleet, 0), Contains("no trial after 4294967295"));
  CHECK(fleet.columns().integer[Fleet::trial * 3] == 1);
  CHECK(fleet.columns().integer[Fleet::trial * 3 + 2] == 3);
  CHECK(fleet.columns().flag[Fleet::terminated * 3] == 1);
}

}  // namespace aloft::python
