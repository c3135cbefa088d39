#include "tools/live/flight_log.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace aloft;
using namespace std::chrono_literals;
using live::FlightLog;
using nlohmann::json;

namespace {

const FlightLog::Clock::time_point start{1000s};

wire::ChannelReport report(std::uint32_t stream, const std::string& agent, std::uint32_t trial, std::uint32_t step,
                           std::uint32_t steps = 4) {
  wire::ChannelReport message;
  message.stream(stream);
  message.agent(wire::name(agent));
  message.relay(wire::name(""));
  message.episode_id(100 * trial + stream);
  message.attempt(1);
  message.condition(2);
  message.trial(trial);
  message.qos_kind(wire::QOS_SPECTRAL_EFFICIENCY);
  message.height_min_m(50);
  message.height_max_m(150);
  message.height_step_m(5);
  message.steps(steps);
  message.step(step);
  message.x_m(10.0 * step);
  message.y_m(-1);
  message.height_m(100 + step);
  message.serving_cell(7);
  message.serving_sinr_db(12.5);
  message.qos(0.25 * step);
  message.reward(0.5);
  message.last(step == steps);
  return message;
}

wire::HeightCommand command(const wire::ChannelReport& answered) {
  wire::HeightCommand message;
  message.stream(answered.stream());
  message.episode_id(answered.episode_id());
  message.attempt(answered.attempt());
  message.step(answered.step() + 1);
  message.agent(answered.agent());
  message.has_introspection(true);
  message.epsilon(0.5);
  message.loss(0.125);
  message.q_values({1.0, 2.0, 3.0});
  return message;
}

}  // namespace

TEST_CASE("the flight of a stream is shown with all agents that fly the same world", "[live]") {
  FlightLog log(3);
  CHECK(log.wants_more(start));
  CHECK(log.view(start)["flight"].is_null());
  log.hear(report(5, "planner", 8, 0), start);  // another world
  CHECK(log.view(start)["flight"].is_null());
  log.hear(report(3, "dqn", 9, 0), start);
  log.hear(command(report(3, "dqn", 9, 0)));
  log.hear(report(4, "min-height", 9, 0), start);
  log.hear(report(3, "dqn", 9, 1), start);
  log.hear(report(4, "min-height", 9, 1), start);
  log.hear(report(4, "min-height", 9, 2), start);
  log.hear(report(5, "planner", 8, 1), start);

  const json view = log.view(start);
  CHECK(view["stream"] == 3);
  CHECK(view["streams"] == json::parse(R"([{"stream": 3, "agent": "dqn", "condition": 2, "trial": 9},
                                           {"stream": 4, "agent": "min-height", "condition": 2, "trial": 9},
                                           {"stream": 5, "agent": "planner", "condition": 2, "trial": 8}])"));
  const json& flight = view["flight"];
  CHECK(flight["condition"] == 2);
  CHECK(flight["trial"] == 9);
  CHECK(flight["over"] == false);
  CHECK(flight["step"] == json{1, 2, 3, 4});
  CHECK(flight["height_max_m"] == 150);
  REQUIRE(flight["agents"].size() == 2);
  const json& dqn = flight["agents"][0];
  CHECK(dqn["name"] == "dqn");
  CHECK(dqn["at"] == 1);
  CHECK(dqn["height_m"] == json{101, nullptr, nullptr, nullptr});
  CHECK(dqn["serving_cell"] == json{7, nullptr, nullptr, nullptr});
  CHECK(dqn["sinr_db"] == json{12.5, nullptr, nullptr, nullptr});
  CHECK(dqn["learning"]["epsilon"] == json{0.5, nullptr, nullptr, nullptr});
  CHECK(dqn["learning"]["loss"] == json{0.125, nullptr, nullptr, nullptr});
  CHECK(dqn["learning"]["q_up"] == json{3.0, nullptr, nullptr, nullptr});
  const json& low = flight["agents"][1];
  CHECK(low["at"] == 2);
  CHECK(low["qos"] == json{0.25, 0.5, nullptr, nullptr});
  CHECK(low["learning"].is_null());
}

TEST_CASE("a relay is one flight, whoever of its crew is asked", "[live]") {
  FlightLog log(std::nullopt);
  wire::ChannelReport first = report(0, "dqn", 1, 1);
  first.relay(wire::name("uav"));
  wire::ChannelReport second = report(0, "planner", 1, 2);
  second.relay(wire::name("uav"));
  log.hear(first, start);
  log.hear(second, start);
  const json flight = log.view(start)["flight"];
  REQUIRE(flight["agents"].size() == 1);
  CHECK(flight["agents"][0]["name"] == "uav");
  CHECK(flight["agents"][0]["height_m"] == json{101, 102, nullptr, nullptr});
}

TEST_CASE("throughput is shown in Mbit/s", "[live]") {
  FlightLog log(0);
  wire::ChannelReport measured = report(0, "dqn", 1, 1);
  measured.qos_kind(wire::QOS_THROUGHPUT);
  measured.qos(12'345.0);
  measured.reward(2'000.0);
  log.hear(measured, start);
  const json agent = log.view(start)["flight"]["agents"][0];
  CHECK(agent["qos"][0] == 12.345);
  CHECK(agent["reward"][0] == 2.0);
}

TEST_CASE("a world that is flown is shown for a while, and nothing is asked for meanwhile", "[live]") {
  FlightLog log(0);
  for (std::uint32_t step = 0; step <= 4; ++step) log.hear(report(0, "a", 1, step), start);
  log.hear(report(1, "b", 1, 3), start);
  CHECK(log.wants_more(start + 500ms));  // b is still in the air
  log.hear(report(1, "b", 1, 4), start + 500ms);
  CHECK(log.wants_more(start + 600ms));
  CHECK_FALSE(log.wants_more(start + 900ms));
  log.hear(report(0, "a", 2, 0), start + 1000ms);
  CHECK(log.view(start + 1000ms)["flight"]["trial"] == 1);
  CHECK(log.view(start + 1000ms)["flight"]["over"] == true);
  CHECK(log.wants_more(start + 3000ms));
  log.hear(report(0, "a", 3, 2), start + 3000ms);  // joined in the air ...
  CHECK(log.view(start + 3000ms)["flight"]["trial"] == 3);
  log.hear(report(0, "a", 4, 1), start + 3100ms);
  CHECK(log.view(start + 3100ms)["flight"]["trial"] == 3);
  log.hear(report(0, "a", 5, 0), start + 3200ms);  // ... gives way to one from its beginning
  CHECK(log.view(start + 3200ms)["flight"]["trial"] == 5);
  log.hear(report(0, "a", 6, 0), start + 3300ms);
  CHECK(log.view(start + 3300ms)["flight"]["trial"] == 5);
}

TEST_CASE("a flight whose process has died gives way", "[live]") {
  FlightLog log(0);
  log.hear(report(0, "a", 1, 0), start);
  log.hear(report(0, "a", 2, 0), start + 9s);
  CHECK(log.view(start + 9s)["flight"]["trial"] == 1);
  log.hear(report(0, "a", 2, 1), start + 11s);
  CHECK(log.view(start + 11s)["flight"]["trial"] == 2);
}

TEST_CASE("a flight that is begun anew replaces the one before, and late reports of that are no part of it", "[live]") {
  FlightLog log(0);
  for (std::uint32_t step = 0; step <= 3; ++step) log.hear(report(0, "a", 1, step), start);
  wire::ChannelReport again = report(0, "a", 1, 1);
  again.attempt(2);
  log.hear(again, start);
  log.hear(report(0, "a", 1, 4), start);
  const json agent = log.view(start)["flight"]["agents"][0];
  CHECK(agent["at"] == 1);
  CHECK(agent["height_m"] == json{101, nullptr, nullptr, nullptr});
}

TEST_CASE("of long flights the latest steps are kept", "[live]") {
  FlightLog log(0);
  constexpr std::uint32_t steps = 16'000;
  for (std::uint32_t step = 0; step <= steps; ++step) log.hear(report(0, "a", 1, step, steps), start);
  log.hear(report(0, "a", 1, 1, steps), start);  // sent again, long forgotten
  const json flight = log.view(start)["flight"];
  CHECK(flight["step"].size() == FlightLog::kept_steps);
  CHECK(flight["step"].back() == steps);
  CHECK(flight["agents"][0]["height_m"].size() == FlightLog::kept_steps);
  CHECK(flight["agents"][0]["at"] == steps);
  CHECK(flight["agents"][0]["x_m"].back() == 160'000);
}
