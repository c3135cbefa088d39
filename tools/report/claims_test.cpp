#include "tools/report/claims.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "tools/report/published.hpp"
#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Comparison compared(double low, double high) {
  return {"a − b", "m", {low, high}, {0.0, infinity}};
}

Claim judged(const char* id, const std::vector<ConditionTrials>& conditions) {
  return judge_claims(conditions, nlohmann::json::array({{{"id", id}, {"text", "as published"}}})).front();
}

std::vector<double> times(double factor, std::vector<double> values) {
  for (double& value : values) value *= factor;
  return values;
}

const std::vector<double> baseline{8.0, 9.0, 10.0, 11.0, 12.0};

}  // namespace

TEST_CASE("A verdict follows from where the intervals lie", "[report]") {
  CHECK(judge(std::vector{compared(0.1, 0.5), compared(2.0, 3.0)}) == Verdict::supported);
  CHECK(judge(std::vector{compared(0.1, 0.5), compared(-1.0, 3.0)}) == Verdict::undecided);
  CHECK(judge(std::vector{compared(-1.0, 3.0), compared(-2.0, -0.1)}) == Verdict::contradicted);
  CHECK(judge(std::vector{compared(0.0, 0.0)}) == Verdict::contradicted);
  CHECK(judge(std::vector<Comparison>{}) == Verdict::undecided);
}

TEST_CASE("Every published claim has a reading, and without data none is decided", "[report]") {
  const auto claims = judge_claims({}, published().at("claims"));
  CHECK(claims.size() == 6);
  for (const Claim& claim : claims) {
    CHECK(claim.verdict == Verdict::undecided);
    CHECK_THAT(claim.reason, Catch::Contains("nothing to compare"));
  }
  CHECK_THROWS_AS(judged("no-such-claim", {}), std::logic_error);
}

TEST_CASE("RL improves QoS by 6 % to 41 %", "[report]") {
  const auto with_gain = [](double factor) {
    return std::vector{
        condition(1, 200, {agent("min-height", "min-height", baseline), agent("dqn", "dqn", times(factor, baseline))})};
  };
  CHECK(judged("rl-improves", with_gain(1.2)).verdict == Verdict::supported);
  CHECK(judged("rl-improves", with_gain(1.5)).verdict == Verdict::contradicted);
  CHECK(judged("rl-improves", with_gain(1.03)).verdict == Verdict::contradicted);
  CHECK(judged("rl-improves", with_gain(0.9)).verdict == Verdict::contradicted);
  // 12 / 8, 11 / 9, ...: on average no gain, trial by trial from -33 % to +50 %.
  const std::vector<double> reversed(baseline.rbegin(), baseline.rend());
  CHECK(judged("rl-improves",
               {condition(1, 200, {agent("min-height", "min-height", baseline), agent("dqn", "dqn", reversed)})})
            .verdict == Verdict::undecided);
}

TEST_CASE("RL and one-step-ahead beat every baseline of the paper on the same worlds", "[report]") {
  std::vector<AgentTrials> agents{
      agent("min-height", "min-height", baseline), agent("constant-120", "constant", times(0.9, baseline)),
      agent("one-step-ahead", "one-step-ahead", times(1.3, baseline)), agent("dqn", "dqn", times(1.01, baseline))};
  CHECK(judged("best-feasible", {condition(1, 200, agents)}).verdict == Verdict::supported);
  // A better agent that is not in the paper does not count.
  agents.push_back(agent("planner", "planner", times(2.0, baseline)));
  CHECK(judged("best-feasible", {condition(1, 200, agents)}).verdict == Verdict::supported);
  agents.push_back(agent("random-walk", "random-walk", times(1.1, baseline)));
  const Claim claim = judged("best-feasible", {condition(1, 200, agents)});
  CHECK(claim.verdict == Verdict::contradicted);
  CHECK_THAT(claim.reason, Catch::Contains("dqn − random-walk"));
  CHECK(claim.details.size() == 6);
}

TEST_CASE("Densities are compared step by step, in ascending order", "[report]") {
  const auto at = [](double density, double factor) {
    return condition(density, 200, {agent("min-height", "min-height", times(factor, baseline))});
  };
  CHECK(judged("density-lowers-qos", {at(5, 0.4), at(1, 1.8), at(2.5, 1.0)}).verdict == Verdict::supported);
  CHECK(judged("density-lowers-qos", {at(5, 1.1), at(1, 1.8), at(2.5, 1.0)}).verdict == Verdict::contradicted);
  CHECK(judged("density-lowers-qos", {at(1, 1.8)}).verdict == Verdict::undecided);
  auto other_radio = at(2.5, 1.0);
  other_radio.other_parameters = "another preset";
  CHECK(judged("density-lowers-qos", {at(1, 1.8), other_radio}).details.empty());
}

TEST_CASE("Building density hardly matters: less than 10 % between neighbours", "[report]") {
  const auto at = [](double density, double factor) {
    return condition(2.5, density, {agent("min-height", "min-height", times(factor, baseline))});
  };
  CHECK(judged("buildings-hardly-matter", {at(100, 1.0), at(200, 1.05), at(300, 1.0)}).verdict == Verdict::supported);
  CHECK(judged("buildings-hardly-matter", {at(100, 1.0), at(200, 1.2)}).verdict == Verdict::contradicted);
}

TEST_CASE("Heights of the adaptive agents and their changes", "[report]") {
  AgentTrials low = agent("one-step-ahead", "one-step-ahead", baseline);
  AgentTrials high = low;
  high.height_m.assign(5, 70.0);
  CHECK(judged("density-raises-height", {condition(1, 200, {low}), condition(5, 200, {high})}).verdict ==
        Verdict::supported);
  CHECK(judged("density-raises-height", {condition(1, 200, {high}), condition(5, 200, {low})}).verdict ==
        Verdict::contradicted);
  AgentTrials calm = agent("dqn", "dqn", baseline);
  AgentTrials busy = low;
  calm.height_changes.assign(5, 10.0);
  busy.height_changes.assign(5, 60.0);
  CHECK(judged("fewer-height-changes", {condition(1, 200, {busy, calm})}).verdict == Verdict::supported);
  calm.height_changes.assign(5, 61.0);
  CHECK(judged("fewer-height-changes", {condition(1, 200, {busy, calm})}).verdict == Verdict::contradicted);
}
