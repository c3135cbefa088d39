#include "tools/report/agent_list.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using nlohmann::json;

namespace {

json listed(std::vector<AgentTrials> agents) {
  const std::vector<ConditionTrials> conditions{condition(1, 200, std::move(agents))};
  return agent_list(conditions);
}

}  // namespace

TEST_CASE("agents keep the colours, dashes and places that they registered", "[report]") {
  const json list = listed({agent("dqn", "dqn", {1.0}), agent("pretrained", "pretrained", {1.0}),
                            agent("constant-90", "constant", {1.0}), agent("planner", "planner", {1.0}),
                            agent("constant-120", "constant", {1.0}), agent("min-height", "min-height", {1.0})});
  std::vector<std::string> names;
  for (const json& one : list) names.push_back(one["name"]);
  CHECK(names == std::vector<std::string>{"min-height", "constant-120", "constant-90", "planner", "pretrained", "dqn"});
  CHECK(list[0]["colour"] == json({{"light", "#2a9fd0"}, {"dark", "#56b4e9"}}));
  CHECK(list[1]["colour"]["light"] == "#882255");
  CHECK(list[1]["dash"] == json({6, 3}));
  CHECK(list[4]["colour"]["light"] == "#aa3377");
  CHECK(list[5]["colour"]["light"] == "#d5500a");
  CHECK(list[5]["dash"] == json({1, 0}));
}

TEST_CASE("agents without a look get the colours of a palette that nobody else here has, in their order", "[report]") {
  json list = listed({agent("one", "dqn", {1.0}), agent("two", "dqn", {1.0})});
  CHECK(list[0]["colour"]["light"] == "#117733");
  CHECK(list[1]["colour"]["light"] == "#aa3377");
  list = listed({agent("one", "dqn", {1.0}), agent("height-filter", "height-filter", {1.0})});
  CHECK(list[0]["colour"]["light"] == "#aa3377");
  CHECK(list[1]["colour"]["light"] == "#117733");
  std::vector<AgentTrials> many;
  for (int i = 0; i < 9; ++i) many.push_back(agent("agent-" + std::to_string(i), "dqn", {1.0}));
  list = listed(many);
  CHECK(list[6]["colour"] == list[0]["colour"]);
  CHECK(list[5]["colour"] != list[0]["colour"]);
}

TEST_CASE("no two agents register the same colour", "[report]") {
  std::set<std::string> light;
  std::set<std::string> dark;
  for (const aloft::agents::AgentType& type : aloft::agents::agent_types())
    for (const aloft::agents::Look& look : type.looks) {
      INFO(look.agent);
      CHECK(light.insert(look.light).second);
      CHECK(dark.insert(look.dark).second);
      CHECK(look.dash.size() % 2 == 0);
      CHECK_FALSE(look.dash.empty());
    }
}
