// The agent's side of the lock-step protocol on one stream, without a bus: every report is handled once.
#include "services/agent_host/pilot.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/bus/convert.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/synthetic_map.hpp"

namespace aloft::agent_host {
namespace {

using Verdict = Pilot::Verdict;

wire::ChannelReport report(std::uint32_t attempt, std::uint32_t step, std::uint32_t steps = 3) {
  wire::ChannelReport message;
  agents::FlightInfo flight;
  flight.height_min_m = 40.0;
  flight.height_max_m = 80.0;
  flight.height_step_m = 10.0;
  flight.steps = steps;
  bus::put(message, flight);
  agents::Observation observation;
  observation.step = step;
  observation.height_m = 40.0;
  observation.last = step == steps;
  bus::put(message, observation);
  message.stream(7);
  message.episode_id(99);
  message.attempt(attempt);
  return message;
}

wire::HeightProfile profile(std::uint32_t attempt, std::uint32_t step) {
  wire::HeightProfile message;
  message.stream(7);
  message.episode_id(99);
  message.attempt(attempt);
  message.step(step);
  message.height_min_m(40.0);
  message.resolution_m(10.0);
  message.qos({1.0, 2.0, 3.0, 2.0, 1.0});
  return message;
}

/// Of a synthetic world with three steps, after `step`.
wire::SiteMap site_map(std::uint32_t attempt, std::uint32_t step, std::uint32_t route_points = 0) {
  flight::SyntheticMap world = flight::SyntheticMap::random(radio::QosKind::spectral_efficiency, 3, 5, 1);
  world.tell_route_in_parts(route_points);
  flight::Flight flight(world, 1, 0);
  for (std::uint32_t i = 0; i < step; ++i) flight.step({}, "pilot");
  wire::SiteMap message;
  bus::put(message, flight.site_map(false));
  message.stream(7);
  message.episode_id(99);
  message.attempt(attempt);
  return message;
}

agents::AgentSpec spec(const char* entry) {
  return agents::parse_agents(nlohmann::json(entry), "test").at(0);
}

/// An agent that carries its memory from each trial to the next.
agents::AgentSpec lifelong() {
  return agents::parse_agents({{"type", "dqn"}, {"memory", "lifelong"}, {"hidden_width", 8}, {"hidden_layers", 1}},
                              "test")
      .at(0);
}

wire::ChannelReport report_of_trial(std::uint32_t trial, std::uint32_t attempt, std::uint32_t step) {
  wire::ChannelReport message = report(attempt, step, 1);
  message.neighbour_sinr_db({4.0, 3.0, 2.0, 1.0});
  message.condition(2);
  message.trial(trial);
  message.episode_id(100 + trial);
  return message;
}

wire::StoredMemory memory_of(std::uint32_t condition, std::uint32_t trial, std::string_view bytes) {
  wire::StoredMemory message;
  message.condition(condition);
  message.trial(trial);
  message.memory(wire::bytes(bytes));
  return message;
}

/// Runs the task, as the host does.
void think(Pilot& pilot) {
  pilot.task().run();
  REQUIRE(pilot.finish() == Verdict::answer);
}

}  // namespace

TEST_CASE("a flight from the first to the last report; repetitions get the same answer") {
  const agents::AgentSpec agent = spec("constant-60");
  Pilot pilot(agent, 7);
  REQUIRE(pilot.offer(report(1, 0)) == Verdict::think);
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);  // its task is still running
  think(pilot);
  CHECK(pilot.answer().step() == 1);
  CHECK(pilot.answer().action() == wire::ACTION_UP);
  CHECK(pilot.offer(report(1, 0)) == Verdict::answer);
  CHECK(pilot.answer().step() == 1);
  REQUIRE(pilot.offer(report(1, 1)) == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().step() == 2);
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);  // stale
  REQUIRE(pilot.offer(report(1, 2)) == Verdict::think);
  think(pilot);
  REQUIRE(pilot.offer(report(1, 3)) == Verdict::think);
  pilot.task().run();
  CHECK(pilot.finish() == Verdict::nothing);
  CHECK(pilot.flights() == 1);
  CHECK_FALSE(pilot.flying());
  CHECK(pilot.offer(report(1, 3)) == Verdict::nothing);
}

TEST_CASE("a flight of which the agent missed a report is unknown to it") {
  const agents::AgentSpec agent = spec("min-height");
  Pilot pilot(agent, 7);
  REQUIRE(pilot.offer(report(1, 1)) == Verdict::answer);
  CHECK(pilot.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
  CHECK(pilot.answer().step() == 2);
  REQUIRE(pilot.offer(report(2, 0)) == Verdict::think);
  think(pilot);
  REQUIRE(pilot.offer(report(2, 2)) == Verdict::answer);
  CHECK(pilot.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
}

TEST_CASE("a crew member comes aboard with the report of its step, and with no other") {
  const agents::AgentSpec agent = spec("constant-60");
  Pilot pilot(agent, 7, {.first_step = 2});
  CHECK(pilot.offer(report(1, 0, 5)) == Verdict::nothing);
  CHECK_FALSE(pilot.aboard(report(1, 2, 5)));
  REQUIRE(pilot.offer(report(1, 2, 5)) == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().step() == 3);
  CHECK(pilot.aboard(report(1, 3, 5)));
  REQUIRE(pilot.offer(report(1, 3, 5)) == Verdict::think);
  think(pilot);
  REQUIRE(pilot.offer(report(2, 3, 5)) == Verdict::answer);  // it was restarted: step 2 is missing
  CHECK(pilot.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
}

TEST_CASE("with failover, a crew member comes aboard at any step, and again after missed reports") {
  const agents::AgentSpec agent = spec("constant-60");
  Pilot pilot(agent, 7, {.first_step = 0, .late = true});
  REQUIRE(pilot.offer(report(1, 3, 9)) == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().step() == 4);
  REQUIRE(pilot.offer(report(1, 4, 9)) == Verdict::think);
  CHECK_FALSE(pilot.task().begins);
  think(pilot);
  REQUIRE(pilot.offer(report(1, 7, 9)) == Verdict::think);
  CHECK(pilot.task().begins);
  think(pilot);
  CHECK(pilot.answer().action() == wire::ACTION_UP);
  CHECK(pilot.offer(report(1, 6, 9)) == Verdict::nothing);
}

TEST_CASE("a new attempt is a new flight, and late messages of the old one are ignored") {
  const agents::AgentSpec agent = spec("min-height");
  Pilot pilot(agent, 7);
  REQUIRE(pilot.offer(report(1, 0)) == Verdict::think);
  CHECK(pilot.offer(report(2, 0)) == Verdict::nothing);  // kept until the task has run
  think(pilot);
  REQUIRE(pilot.resume() == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().attempt() == 2);
  CHECK(pilot.offer(report(1, 1)) == Verdict::nothing);
  CHECK(pilot.offer(report(0xFFFFFFFF, 1)) == Verdict::nothing);  // older: the numbers wrap around
}

TEST_CASE("a report waits for the profile that it needs") {
  const agents::AgentSpec agent = spec("one-step-ahead");
  Pilot pilot(agent, 7);
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);
  CHECK(pilot.resume() == Verdict::nothing);
  pilot.foresee(profile(1, 1));
  REQUIRE(pilot.resume() == Verdict::think);
  CHECK(pilot.task().profiles.size() == 1);
  think(pilot);
  CHECK(pilot.answer().action() == wire::ACTION_UP);  // the best height is 60 m
  pilot.foresee(profile(1, 1));                       // a repetition, no longer needed
  CHECK(pilot.offer(report(1, 1)) == Verdict::nothing);
  pilot.foresee(profile(1, 2));
  REQUIRE(pilot.resume() == Verdict::think);
  CHECK(pilot.task().profiles.size() == 1);
}

TEST_CASE("an agent that plans the route waits for all profiles once, whatever their order") {
  const agents::AgentSpec agent = spec("planner");
  Pilot pilot(agent, 7);
  for (const std::uint32_t step : {3U, 1U}) pilot.foresee(profile(1, step));
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);
  pilot.foresee(profile(1, 2));
  REQUIRE(pilot.resume() == Verdict::think);
  REQUIRE(pilot.task().profiles.size() == 3);
  CHECK(pilot.task().profiles[2].step == 3);
  think(pilot);
  pilot.foresee(profile(1, 2));  // sent again because the channel had asked twice
  REQUIRE(pilot.offer(report(1, 1)) == Verdict::think);
  CHECK(pilot.task().profiles.empty());
}

TEST_CASE("a report waits for the site map: the whole one for the first, none for later ones") {
  const agents::AgentSpec agent = spec("site-planner");
  Pilot pilot(agent, 7);
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);
  pilot.survey(site_map(2, 0));  // of a flight that begins later
  CHECK(pilot.resume() == Verdict::nothing);
  pilot.survey(site_map(1, 0));  // older
  CHECK(pilot.resume() == Verdict::nothing);
  Pilot other(agent, 7);
  CHECK(other.offer(report(1, 0)) == Verdict::nothing);
  wire::SiteMap update = site_map(1, 0);
  update.update(true);
  update.sites().clear();
  update.radio_json().clear();
  other.survey(update);
  CHECK(other.resume() == Verdict::nothing);  // the sites are missing
  other.survey(site_map(1, 0));
  other.survey(update);  // does not displace the whole map
  REQUIRE(other.resume() == Verdict::think);
  REQUIRE(other.task().map);
  CHECK(other.task().map->known.sites.size() == 12);
  think(other);
  other.survey(site_map(1, 0));  // sent again, no longer needed
  REQUIRE(other.offer(report(1, 1)) == Verdict::think);
  CHECK_FALSE(other.task().map);
}

TEST_CASE("where the route is told in parts, every report but the last waits for its part") {
  const agents::AgentSpec agent = spec("site-planner");
  Pilot pilot(agent, 7);
  pilot.survey(site_map(1, 0, 2));
  REQUIRE(pilot.offer(report(1, 0)) == Verdict::think);
  think(pilot);
  CHECK(pilot.offer(report(1, 1)) == Verdict::nothing);
  pilot.survey(site_map(1, 1, 2));
  REQUIRE(pilot.resume() == Verdict::think);
  CHECK(pilot.task().map->route.size() == 2);
  think(pilot);
  pilot.survey(site_map(1, 2, 2));
  REQUIRE(pilot.offer(report(1, 2)) == Verdict::think);
  think(pilot);
  REQUIRE(pilot.offer(report(1, 3)) == Verdict::think);
}

TEST_CASE("a map whose radio is no world's is refused, and none of it is used") {
  const agents::AgentSpec agent = spec("site-planner");
  Pilot pilot(agent, 7);
  wire::SiteMap map = site_map(1, 0);
  map.radio_json(wire::bytes(R"({"tx_power_w": -3})"));
  CHECK_THROWS_AS(pilot.survey(map), InputError);
  CHECK(pilot.offer(report(1, 0)) == Verdict::nothing);
}

TEST_CASE("an agent with a memory hands it over after its flight, and needs it before the next one") {
  const agents::AgentSpec agent = lifelong();
  Pilot first(agent, 7);
  REQUIRE(first.offer(report_of_trial(0, 1, 0)) == Verdict::think);  // the first of its lineage
  think(first);
  REQUIRE(first.offer(report_of_trial(0, 1, 1)) == Verdict::think);
  first.task().run();
  REQUIRE(first.finish() == Verdict::hand_over);
  CHECK(first.memory().stream() == 7);
  CHECK(first.memory().episode_id() == 100);
  CHECK(first.memory().attempt() == 1);
  const std::string memory(wire::view(first.memory().memory()));
  CHECK(memory == first.task().agent->save_state());
  CHECK(first.offer(report_of_trial(0, 1, 1)) == Verdict::hand_over);  // the channel asks again
  CHECK(wire::view(first.memory().memory()) == memory);

  Pilot second(agent, 7);  // in another process
  CHECK(second.offer(report_of_trial(1, 5, 0)) == Verdict::nothing);
  REQUIRE(second.wanted_memory() == Pilot::EarlierFlight{2, 0});
  CHECK_FALSE(second.remember(memory_of(1, 0, memory)));  // of another condition
  CHECK_FALSE(second.remember(memory_of(2, 1, memory)));  // of another trial
  CHECK(second.offer(report_of_trial(1, 5, 0)) == Verdict::nothing);
  CHECK(second.remember(memory_of(2, 0, memory)));
  REQUIRE(second.resume() == Verdict::think);
  CHECK(second.task().memory == memory);
  CHECK_FALSE(second.wanted_memory());
  think(second);
  CHECK(second.resume() == Verdict::answer);  // the repetition that was kept
  CHECK(second.resume() == Verdict::nothing);
}

TEST_CASE("a memory lost before it is handed over makes the agent fly again; an unreadable one is refused") {
  const agents::AgentSpec agent = lifelong();
  Pilot restarted(agent, 7);
  REQUIRE(restarted.offer(report_of_trial(0, 1, 1)) == Verdict::answer);
  CHECK(restarted.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
  CHECK(restarted.answer().step() == 2);

  Pilot pilot(agent, 7);
  CHECK(pilot.offer(report_of_trial(1, 2, 0)) == Verdict::nothing);
  CHECK(pilot.remember(memory_of(2, 0, "not a memory")));
  REQUIRE(pilot.resume() == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
  CHECK(pilot.offer(report_of_trial(1, 3, 0)) == Verdict::nothing);  // the next attempt requests it again
  CHECK(pilot.wanted_memory());
}

TEST_CASE("an agent that fails asks for the flight to start again") {
  const agents::AgentSpec broken{"broken", "external", {}, {}};
  Pilot pilot(broken, 7);
  REQUIRE(pilot.offer(report(1, 0)) == Verdict::think);
  think(pilot);
  CHECK(pilot.answer().action() == wire::ACTION_UNKNOWN_FLIGHT);
  CHECK_FALSE(pilot.task().error.empty());
  CHECK(pilot.offer(report(2, 0)) == Verdict::think);
}

}  // namespace aloft::agent_host
