#include "tools/report/claims.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "tools/report/published.hpp"
#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using Catch::Contains;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Comparison compared(double low, double high) {
  return {"a − b", "m", {low, high}, {0.0, infinity}};
}

Claim judged(const std::string& id, const std::vector<ConditionTrials>& conditions) {
  for (const nlohmann::json& claim : published().at("claims"))
    if (claim.at("id") == id) return judge_claims(conditions, nlohmann::json::array({claim})).front();
  return judge_claims(conditions, nlohmann::json::array({{{"id", id}, {"text", "not published"}}})).front();
}

/// The values 8, 9, ..., 12, repeated over 40 trials.
std::vector<double> quality(double factor) {
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) values.push_back(factor * (8.0 + i % 5));
  return values;
}

/// Agents by name, and the factor between their quality and quality(1).
using Factors = std::map<std::string, double>;

AgentTrials flown(const std::string& name, double factor) {
  return agent(name, name.starts_with("constant") ? "constant" : name, quality(factor));
}

/// All that the paper flew in a generated world.
std::vector<AgentTrials> papers_agents(const Factors& factors) {
  std::vector<AgentTrials> agents;
  for (const char* name :
       {"min-height", "constant-120", "constant-240", "random-walk", "one-step-ahead", "optimal-height", "dqn"})
    agents.push_back(flown(name, factors.contains(name) ? factors.at(name) : 1.0));
  return agents;
}

/// The same agents in all five worlds of the paper.
std::vector<ConditionTrials> everywhere(const std::vector<AgentTrials>& agents) {
  return {condition(1, 200, agents), condition(2.5, 200, agents), condition(5, 200, agents),
          condition(2.5, 100, agents), condition(2.5, 300, agents)};
}

ConditionTrials world(double bs_density_per_km2, double building_density_per_km2, double factor) {
  std::vector<AgentTrials> agents = papers_agents({});
  for (AgentTrials& one : agents) one.qos = quality(factor);
  return condition(bs_density_per_km2, building_density_per_km2, agents);
}

}  // namespace

TEST_CASE("A verdict follows from where the intervals lie", "[report]") {
  CHECK(judge(std::vector{compared(0.1, 0.5), compared(2.0, 3.0)}) == Verdict::supported);
  CHECK(judge(std::vector{compared(0.1, 0.5), compared(-1.0, 3.0)}) == Verdict::undecided);
  CHECK(judge(std::vector{compared(-1.0, 3.0), compared(-2.0, -0.1)}) == Verdict::contradicted);
  CHECK(judge(std::vector{compared(0.0, 0.0)}) == Verdict::contradicted);
  CHECK(judge(std::vector<Comparison>{}) == Verdict::not_applicable);
}

TEST_CASE("Every published claim has a reading, and without data none applies", "[report]") {
  const auto claims = judge_claims({}, published().at("claims"));
  CHECK(claims.size() == 6);
  for (const Claim& claim : claims) {
    CHECK(claim.verdict == Verdict::not_applicable);
    CHECK_THAT(claim.reason, Contains("It needs") && Contains("at least 30 trials"));
  }
  CHECK_THROWS_AS(judged("no-such-claim", {}), std::logic_error);
}

TEST_CASE("RL improves QoS by 6 % to 41 %", "[report]") {
  const auto with_gain = [](double factor) { return everywhere(papers_agents({{"dqn", factor}})); };
  CHECK(judged("rl-improves", with_gain(1.2)).verdict == Verdict::supported);
  CHECK(judged("rl-improves", with_gain(1.5)).verdict == Verdict::contradicted);
  CHECK(judged("rl-improves", with_gain(1.03)).verdict == Verdict::contradicted);
  CHECK(judged("rl-improves", with_gain(0.9)).verdict == Verdict::contradicted);
  // No gain on average; single trials from -33 % to +50 %.
  std::vector<AgentTrials> agents = papers_agents({});
  std::reverse(agents.back().qos.begin(), agents.back().qos.end());
  CHECK(judged("rl-improves", everywhere(agents)).verdict == Verdict::undecided);
}

TEST_CASE("A claim is supported only if all worlds and agents that it speaks of have flown", "[report]") {
  std::vector<ConditionTrials> worlds = everywhere(papers_agents({{"dqn", 1.2}}));
  worlds.pop_back();
  const Claim without_world = judged("rl-improves", worlds);
  CHECK(without_world.verdict == Verdict::undecided);
  CHECK_THAT(without_world.reason, Contains("all at 2.5 / 300"));
  worlds = everywhere(papers_agents({{"dqn", 1.2}}));
  worlds[0].agents.erase(worlds[0].agents.begin() + 2);
  CHECK_THAT(judged("rl-improves", worlds).reason, Contains("constant-240 at 1 / 200."));
  CHECK(judged("rl-improves", {worlds[0]}).verdict == Verdict::undecided);
  worlds[0] = condition(1, 200, papers_agents({{"dqn", 0.9}}));  // one world is enough to contradict
  CHECK(judged("rl-improves", {worlds[0]}).verdict == Verdict::contradicted);
}

TEST_CASE("Two runs over the same worlds count as one", "[report]") {
  const auto only = [](std::vector<AgentTrials> agents, auto wanted) {
    std::erase_if(agents,
                  [&](const AgentTrials& one) { return !wanted(one.name == "dqn" || one.name == "min-height"); });
    return everywhere(agents);
  };
  std::vector<ConditionTrials> runs = only(papers_agents({}), [](bool costly) { return !costly; });
  for (const ConditionTrials& costly : only(papers_agents({{"dqn", 1.2}}), [](bool costly) { return costly; }))
    runs.push_back(costly);
  CHECK(judged("rl-improves", runs).verdict == Verdict::supported);
  for (std::size_t i = 5; i < runs.size(); ++i) runs[i].seed = 7;  // other worlds
  CHECK(judged("rl-improves", runs).verdict == Verdict::undecided);
}

TEST_CASE("RL and one-step-ahead beat every baseline of the paper on the same worlds", "[report]") {
  const Factors factors{{"constant-120", 0.9}, {"one-step-ahead", 1.3}, {"dqn", 1.01}};
  CHECK(judged("best-feasible", everywhere(papers_agents(factors))).verdict == Verdict::supported);
  // A better agent that is not in the paper does not count.
  std::vector<AgentTrials> agents = papers_agents(factors);
  agents.push_back(flown("planner", 2.0));
  CHECK(judged("best-feasible", everywhere(agents)).verdict == Verdict::supported);
  Factors better_walk = factors;
  better_walk["random-walk"] = 1.1;
  const Claim claim = judged("best-feasible", everywhere(papers_agents(better_walk)));
  CHECK(claim.verdict == Verdict::contradicted);
  CHECK_THAT(claim.reason, Contains("dqn − random-walk"));
  CHECK(claim.details.size() == 5 * 2 * 4);
}

TEST_CASE("Densities are compared step by step, in ascending order", "[report]") {
  CHECK(judged("density-lowers-qos", {world(5, 200, 0.4), world(1, 200, 1.8), world(2.5, 200, 1.0)}).verdict ==
        Verdict::supported);
  CHECK(judged("density-lowers-qos", {world(5, 200, 1.1), world(1, 200, 1.8), world(2.5, 200, 1.0)}).verdict ==
        Verdict::contradicted);
  CHECK(judged("density-lowers-qos", {world(1, 200, 1.8)}).verdict == Verdict::not_applicable);
}

TEST_CASE("Building density hardly matters: less than 10 % between neighbours", "[report]") {
  CHECK(
      judged("buildings-hardly-matter", {world(2.5, 100, 1.0), world(2.5, 200, 1.05), world(2.5, 300, 1.0)}).verdict ==
      Verdict::supported);
  CHECK(judged("buildings-hardly-matter", {world(2.5, 100, 1.0), world(2.5, 200, 1.2)}).verdict ==
        Verdict::contradicted);
}

TEST_CASE("Heights of the adaptive agents and their changes", "[report]") {
  const auto at = [](double bs_density_per_km2, double height_m) {
    ConditionTrials result = world(bs_density_per_km2, 200, 1.0);
    for (AgentTrials& one : result.agents) one.metrics["height_mean_m"].assign(one.trials.size(), height_m);
    return result;
  };
  CHECK(judged("density-raises-height", {at(1, 40.0), at(2.5, 55.0), at(5, 70.0)}).verdict == Verdict::supported);
  CHECK(judged("density-raises-height", {at(1, 70.0), at(5, 40.0)}).verdict == Verdict::contradicted);

  const auto busy = [](double learner_changes) {
    std::vector<AgentTrials> agents = papers_agents({});
    for (AgentTrials& one : agents)
      one.metrics["height_changes"].assign(one.trials.size(), one.name == "dqn" ? learner_changes : 60.0);
    return everywhere(agents);
  };
  CHECK(judged("fewer-height-changes", busy(10.0)).verdict == Verdict::supported);
  CHECK(judged("fewer-height-changes", busy(61.0)).verdict == Verdict::contradicted);
}

TEST_CASE("A claim does not apply to what is not the paper's, and says why", "[report]") {
  const auto reason_of = [](const char* id, const std::vector<ConditionTrials>& conditions) {
    const Claim claim = judged(id, conditions);
    CHECK(claim.verdict == Verdict::not_applicable);
    return claim.reason;
  };
  std::vector<ConditionTrials> worlds = everywhere(papers_agents({{"dqn", 1.2}}));
  for (ConditionTrials& one : worlds) one.world_parameters["uav_beamwidth_deg"] = 60;
  CHECK_THAT(reason_of("rl-improves", worlds),
             Contains("uav_beamwidth_deg 60 instead of 45") && Contains("and 1 more"));

  CHECK_THAT(reason_of("density-lowers-qos", {world(2, 200, 1.0), world(4, 200, 0.5)}),
             Contains("the paper has no world with 2 base stations and 200 buildings per km²"));

  worlds = everywhere(papers_agents({{"dqn", 1.2}}));
  for (ConditionTrials& one : worlds)
    for (AgentTrials& flights : one.agents) {
      flights.trials.resize(29);
      flights.qos.resize(29);
    }
  CHECK_THAT(reason_of("best-feasible", worlds), Contains("29 trials, at least 30 are needed"));

  worlds = everywhere(papers_agents({{"dqn", 1.2}}));
  for (ConditionTrials& one : worlds) one.agents.back().parameters["hidden_width"] = 64;
  CHECK_THAT(reason_of("rl-improves", worlds), Contains("'dqn' is not the paper's: hidden_width 64 instead of 200"));
}
