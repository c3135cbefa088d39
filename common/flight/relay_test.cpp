// Several agents in one flight.
#include "common/flight/relay.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/flight/testing/synthetic_map.hpp"

namespace aloft::flight {
namespace {

using radio::QosKind;
using Json = nlohmann::json;

agents::AgentSpec relay(const Json& crew) {
  return agents::parse_agents({{"type", "relay"}, {"name", "relay"}, {"crew", crew}}, "test").at(0);
}

std::vector<double> heights_m(const FlightRecord& record) {
  std::vector<double> heights;
  for (const StepRecord& step : record.steps) heights.push_back(step.height_m);
  return heights;
}

}  // namespace

TEST_CASE("each member flies from its step on, and the record says so") {
  SyntheticMap map = SyntheticMap::random(QosKind::spectral_efficiency, 9, 9, 1);
  const FlightRecord record = fly_relay(map, 1, 0, relay(Json::parse(R"([{"agent": "constant-70"},
                                          {"agent": "min-height", "from_step": 5, "shadow": false},
                                          {"agent": "constant-60", "from_step": 8}, {"agent": "random-walk"}])")));
  CHECK(heights_m(record) == std::vector<double>{50, 60, 70, 70, 60, 50, 40, 50, 60});
  CHECK(record.pilots == std::vector<std::string>{"constant-70", "min-height", "constant-60"});
  std::vector<std::uint32_t> pilots;
  for (const StepRecord& step : record.steps) pilots.push_back(step.flown_by);
  CHECK(pilots == std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 2, 2});
}

TEST_CASE("a shadow learns what the pilot learns: after a relay between two alike, a flight is as if one flew alone") {
  for (const QosKind kind : {QosKind::spectral_efficiency, QosKind::throughput}) {
    for (const Json& agent :
         {Json{{"type", "dqn"}, {"epochs", 3}, {"hidden_width", 16}}, Json{{"type", "local-bandit"}},
          Json{{"type", "height-filter"}}, Json{{"type", "pretrained"}}, Json{{"type", "random-walk"}}}) {
      INFO(agent.dump());
      SyntheticMap map = SyntheticMap::random(kind, 60, 12, 3);
      const agents::AgentSpec alone = agents::parse_agents(agent, "test").at(0);
      const FlightRecord expected = fly(map, 7, 2, *alone.make(), alone);
      Json second = agent;
      second["name"] = "second";
      const auto relieved = [&](bool shadow) {
        return fly_relay(map, 7, 2,
                         relay({{{"agent", agent}}, {{"agent", second}, {"from_step", 31}, {"shadow", shadow}}}));
      };
      const FlightRecord record = relieved(true);
      CHECK(heights_m(record) == heights_m(expected));
      CHECK(record.pilots == std::vector<std::string>{alone.name, "second"});
      if (agent["type"] == "dqn") {
        CHECK(record.steps.back().introspection->q_values == expected.steps.back().introspection->q_values);
        // Without shadowing it begins as in a first step: every action is random.
        const FlightRecord cold = relieved(false);
        CHECK(cold.steps[29].introspection->epsilon == expected.steps[29].introspection->epsilon);
        CHECK(cold.steps[30].introspection->epsilon == 1.0);
        CHECK(cold.steps[30].introspection->loss == 0.0);
        CHECK(record.steps[30].introspection->epsilon == Approx(0.05));
      }
    }
  }
}

}  // namespace aloft::flight
