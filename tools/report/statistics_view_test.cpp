#include "tools/report/statistics_view.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using nlohmann::json;

TEST_CASE("Box plots end at the last value within 1.5 box lengths", "[report]") {
  // quartiles 2 and 4, fences at -1 and 7
  const json view =
      statistics_view(condition(1, 200, {agent("min-height", "min-height", {100.0, 3.0, 1.0, 4.0, 2.0})}));
  const json& row = view["agents"][0];
  CHECK(view["trials"] == 5);
  CHECK(row["median"] == 3.0);
  CHECK(row["q25"] == 2.0);
  CHECK(row["q75"] == 4.0);
  CHECK(row["whiskers"] == json({1.0, 4.0}));
  CHECK(row["outliers"] == json({100.0}));
  CHECK(row["mean"] == 22.0);
}

TEST_CASE("Gains pair the trials that both agents have flown", "[report]") {
  AgentTrials learner = agent("dqn", "dqn", {5.0, 9.0, 2.0});
  learner.trials = {0, 2, 7};  // trial 7 has no partner
  const json view =
      statistics_view(condition(1, 200, {agent("min-height", "min-height", {4.0, 100.0, 10.0}), learner}));
  const json& gain = view["agents"][1]["gain"];
  CHECK(gain["pairs"] == 2);
  CHECK(gain["mean"] == 0.0);  // (5 - 4 + 9 - 10) / 2
  CHECK(gain["ci95"] == json({-1.0, 1.0}));
  CHECK(gain["probability_of_improvement"] == 0.5);
}

TEST_CASE("The share of the head-room runs from min-height to the planner", "[report]") {
  const json view = statistics_view(condition(
      1, 200,
      {agent("min-height", "min-height", {4.0, 6.0}), agent("planner", "planner", {10.0, 8.0}),  // gains 6 and 2
       agent("dqn", "dqn", {5.0, 6.0})}));
  CHECK(view["agents"][0]["headroom_share"] == 0.0);
  CHECK(view["agents"][1]["headroom_share"] == 1.0);
  CHECK(view["agents"][2]["headroom_share"] == 0.125);  // 0.5 of 4
  CHECK(view["agents"][2]["metrics"]["energy"] == 12.5);
  CHECK(view["agents"][2]["metrics"]["handovers"] == 3.0);
  const json without = statistics_view(condition(1, 200, {agent("min-height", "min-height", {4.0})}));
  CHECK(without["agents"][0]["headroom_share"].is_null());
}

TEST_CASE("Heights flown are shares of the steps of all flights", "[report]") {
  AgentTrials low = agent("min-height", "min-height", {4.0, 6.0});
  AgentTrials high = agent("planner", "planner", {4.0, 6.0});
  high.steps_at_m = {{{40.0, 10}, {60.0, 90}}, {{60.0, 30}, {110.0, 70}}};
  const json view = statistics_view(condition(1, 200, {low, high}));
  CHECK(view["agents"][0]["heights"] == json({{"height_m", {40.0}}, {"share", {1.0}}}));
  CHECK(view["agents"][1]["heights"] == json({{"height_m", {40.0, 60.0, 110.0}}, {"share", {0.05, 0.6, 0.35}}}));
}

TEST_CASE("A performance profile counts the trials above each threshold", "[report]") {
  const json view = statistics_view(condition(1, 200, {agent("min-height", "min-height", {0.0, 2.0, 4.0, 8.0})}));
  const json& thresholds = view["profile_thresholds"];
  const json& profile = view["agents"][0]["profile"];
  CHECK(thresholds.front() == 0.0);
  CHECK(thresholds.back() == 8.0);
  REQUIRE(thresholds[40] == 4.0);
  CHECK(profile[0] == 0.75);
  CHECK(profile[39] == 0.5);
  CHECK(profile[40] == 0.25);
  CHECK(profile.back() == 0.0);
}

TEST_CASE("The selected view keeps the trials that the learner won, for all agents", "[report]") {
  const auto all =
      condition(1, 200,
                {agent("constant-120", "constant", {5.0, 5.0, 5.0, 5.0}),
                 agent("min-height", "min-height", {1.0, 2.0, 3.0, 4.0}), agent("dqn", "dqn", {6.0, 5.0, 4.0, 7.0})});
  const auto kept = selected(all, "dqn", "constant-120");
  REQUIRE(kept);
  CHECK(kept->agent("min-height")->trials == std::vector<std::uint32_t>{0, 3});
  CHECK(kept->agent("min-height")->qos == std::vector<double>{1.0, 4.0});
  CHECK_FALSE(selected(all, "dqn", "constant-240"));
  CHECK(statistics_view(condition(1, 200, {agent("dqn", "dqn", {})})).is_null());
}

TEST_CASE("Numbers in the data block are as short as what is shown", "[report]") {
  CHECK(rounded(12.345678) == 12.3457);
  CHECK(rounded(std::numeric_limits<double>::quiet_NaN()).is_null());
  CHECK(significant(0.0000123456).get<double>() == Approx(0.00001235));
  CHECK(significant(-98765.0).get<double>() == Approx(-98770.0));
  CHECK(significant(0.0) == 0.0);
}
