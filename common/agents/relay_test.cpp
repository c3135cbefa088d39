// Relays: the members of a crew, and which of them flies when.
#include "common/agents/relay.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

using Catch::Contains;
using Json = nlohmann::json;

AgentSpec relay(const Json& crew) {
  return parse_agents({{"type", "relay"}, {"name", "both"}, {"crew", crew}}, "agents[3]").at(0);
}

std::string refusal(const Json& crew) {
  try {
    static_cast<void>(relay(crew));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a relay's crew: defaults, order, and the round trip through its canonical form") {
  const AgentSpec spec = relay(Json::parse(R"([{"agent": "min-height"},
    {"agent": {"type": "dqn", "name": "learner", "epochs": 5}, "from_step": 20, "shadow": false},
    {"agent": "constant-60", "from_step": 21}, {"agent": "random-walk"}, {"agent": "constant-80", "shadow": false}])"));
  REQUIRE(spec.crew.size() == 5);
  CHECK(spec.crew[0].from_step == 1);
  CHECK(spec.crew[1].agent.name == "learner");
  CHECK(spec.crew[1].agent.parameters.integer("epochs") == 5);
  CHECK(spec.crew[0].boards_at() == 0U);
  CHECK(spec.crew[1].boards_at() == 19U);  // its first command makes step 20 of what step 19 reports
  CHECK(spec.crew[2].boards_at() == 0U);
  CHECK(spec.crew[3].boards_at() == 0U);
  CHECK_FALSE(spec.crew[4].boards_at());
  for (const auto& [step, pilot] : {std::pair(1U, 0U), {19U, 0U}, {20U, 1U}, {21U, 2U}, {22U, 2U}, {9999U, 2U}})
    CHECK(written_pilot(spec.crew, step) == pilot);
  CHECK(parse_agents(spec.to_json(), "again").at(0).to_json() == spec.to_json());
  CHECK_THROWS_AS(spec.make(), std::logic_error);
}

TEST_CASE("a crew that cannot fly is refused with the reason and the place") {
  const Json first = {{"agent", "min-height"}};
  const auto with = [&](const char* second) { return refusal({first, Json::parse(second)}); };
  CHECK(with(R"({"agent": "random-walk"})").empty());
  CHECK_THAT(refusal(Json::array({first})), Contains("agents[3]") && Contains("crew") && Contains("2 to 8"));
  CHECK_THAT(refusal("min-height"), Contains("crew"));
  CHECK_THAT(refusal({{{"agent", "min-height"}, {"from_step", 2}}, first}), Contains("crew[0].from_step: 2"));
  CHECK_THAT(with(R"({"agent": "min-height"})"), Contains("crew[1]") && Contains("already"));
  CHECK_THAT(with(R"({"agent": "random-walk", "from_step": 1})"), Contains("crew[1].from_step: 1"));
  CHECK_THAT(with(R"({"agent": "random-walk", "from_step": -1})"), Contains("from_step") && Contains("10000"));
  CHECK_THAT(with(R"({"agent": "random-walk", "form_step": 7})"), Contains("from_step"));
  CHECK_THAT(with(R"({"agent": "random-wlak"})"), Contains("random-walk"));
  CHECK_THAT(with(R"({"agent": "planner"})"), Contains("planner") && Contains("privileged"));
  CHECK_THAT(with(R"({"agent": {"type": "external", "name": "seer", "privilege": "next-step"}, "shadow": false})"),
             Contains("seer") && Contains("privileged"));
  CHECK_THAT(with(R"({"agent": {"type": "dqn", "memory": "lifelong"}})"), Contains("per-flight"));
  CHECK_THAT(with(R"({"agent": {"type": "dqn", "epochs": [1, 2]}})"), Contains("one value"));
  CHECK_THAT(with(R"({"agent": {"type": "external", "name": "visitor"}})"), Contains("\"shadow\": false"));
  CHECK_THAT(with(R"({"agent": {"type": "relay", "name": "inner", "crew": ["min-height", "random-walk"]}})"),
             Contains("crew"));
  CHECK_THAT(with(R"("random-walk")"), Contains("object"));
  CHECK_THROWS_AS(parse_agents({{"type", "relay"}, {"crew", {first, {{"agent", "random-walk"}}}}}, "x"), InputError);
  CHECK_THROWS_AS(parse_agents("relay", "x"), InputError);
}

}  // namespace aloft::agents
