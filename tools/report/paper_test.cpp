#include "tools/report/paper.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tools/report/published.hpp"
#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A measured flight whose file has this SHA-256.
ConditionTrials measured(const std::string& sha256, std::vector<AgentTrials> agents) {
  ConditionTrials result = condition(2.5, 200, std::move(agents));
  result.kind = aloft::experiment::WorldKind::measured;
  result.name = result.label = result.measured_file = "gcq";
  result.world_parameters = {{"file", "/flights/gcq.csv"}, {"file_sha256", sha256}};
  return result;
}

std::string gcq() {
  return published().at("measured_flights").at("GCQ").at("sha256").get<std::string>();
}

AgentTrials flown(const json& entry, std::size_t trials = 30) {
  const auto spec = aloft::agents::parse_agents(entry, "test").front();
  AgentTrials result = agent(spec.type, spec.type, std::vector<double>(trials, 1.0));
  result.name = spec.name;
  result.parameters = spec.parameters.to_json();
  return result;
}

}  // namespace

TEST_CASE("The paper's worlds are its five pairs of densities with all of its settings", "[report]") {
  for (const json& world : published().at("generated_worlds"))
    CHECK(why_not_the_papers(condition(world.at("bs_density_per_km2").get<double>(),
                                       world.at("building_density_per_km2").get<double>(), {})) == "");
  CHECK_THAT(why_not_the_papers(condition(3, 200, {})), Contains("no world with 3 base stations and 200 buildings"));
  CHECK_THAT(why_not_the_papers(condition(5, 100, {})), Contains("no world with 5 base stations and 100 buildings"));

  ConditionTrials other = condition(1, 200, {});
  other.world_parameters["uav_beamwidth_deg"] = 60;
  other.world_parameters["steps"] = 50;
  CHECK_THAT(why_not_the_papers(other),
             Contains("uav_beamwidth_deg 60 instead of 45") && Contains("steps 50 instead of 100"));
  other.world_parameters["spectral_efficiency_max"] = 7.4;
  CHECK_THAT(why_not_the_papers(other), Contains("spectral_efficiency_max 7.4 instead of 0"));
  other = condition(1, 200, {});
  other.world_parameters["preset"] = "geometric";  // a name; the switches behind it count
  CHECK(why_not_the_papers(other) == "");
  other.costs.energy_weight = 0.005;
  CHECK_THAT(why_not_the_papers(other), Contains("energy_weight"));
}

TEST_CASE("A measured flight is the paper's by its SHA-256, not by its name", "[report]") {
  CHECK(why_not_the_papers(measured(gcq(), {})) == "");
  CHECK(papers_flight(measured(gcq(), {})) == "GCQ");
  const ConditionTrials other = measured("a665a45920422f9d417e4867efdc4fb8a04a1f3fff1fa07e998e86f7f7a27ae3", {});
  CHECK(papers_flight(other) == "");
  CHECK_THAT(why_not_the_papers(other),
             Contains("SHA-256, a665a459…") && Contains("GCQ is 314fd3b2…") && Contains("that of NWQ is not known"));
}

TEST_CASE("An agent is the paper's by its type and parameters, not by its name", "[report]") {
  const auto found = [](const json& entry, const char* name) {
    return papers_agent(condition(1, 200, {flown(entry)}), name);
  };
  CHECK(found("dqn", "dqn").trials != nullptr);
  CHECK(found(json{{"type", "dqn"}, {"name", "learner"}}, "dqn").trials != nullptr);
  const json as_published{{"type", "dqn"},           {"name", "code"},       {"loss", "cross-entropy"},
                          {"target_network", false}, {"memory", "lifelong"}, {"input_scaling", "linear-max"}};
  CHECK(found(as_published, "dqn").trials != nullptr);
  CHECK(found(json{{"type", "constant"}, {"height_m", 120}, {"name", "high"}}, "constant-120").trials != nullptr);

  const PapersAgent half = found(json{{"type", "dqn"}, {"name", "dqn"}, {"loss", "cross-entropy"}}, "dqn");
  CHECK(half.trials == nullptr);
  CHECK_THAT(half.why_not, Contains("loss \"cross-entropy\" instead of \"mse\""));
  CHECK_THAT(found(json{{"type", "constant"}, {"height_m", 60}, {"name", "constant-120"}}, "constant-120").why_not,
             Contains("height_m 60 instead of 120"));
  CHECK_THAT(found(json{{"type", "one-step-ahead"}, {"target_resolution_m", 10}}, "one-step-ahead").why_not,
             Contains("target_resolution_m"));
  CHECK(found("planner", "dqn").trials == nullptr);  // has not flown: nothing to say
  CHECK(found("planner", "dqn").why_not == "");
}

TEST_CASE("Fewer than 30 trials, and agents that flew otherwise over measured flights, do not count", "[report]") {
  CHECK(papers_agent(condition(1, 200, {flown("dqn", 30)}), "dqn").trials != nullptr);
  CHECK_THAT(papers_agent(condition(1, 200, {flown("dqn", 29)}), "dqn").why_not,
             Contains("29 trials, at least 30 are needed"));
  const ConditionTrials flight = measured(gcq(), {flown("one-step-ahead"), flown("min-height")});
  CHECK_THAT(papers_agent(flight, "one-step-ahead").why_not, Contains("aims at another step"));
  CHECK(papers_agent(flight, "min-height").trials != nullptr);
}

TEST_CASE("The paper's share of a report: its agents under its names, and why the rest is left out", "[report]") {
  const std::vector<ConditionTrials> conditions{
      condition(1, 200,
                {flown(json{{"type", "dqn"}, {"name", "learner"}}), flown("planner"), flown("random-walk", 12)}),
      condition(3, 200, {flown("dqn")}), condition(5, 200, {flown("dqn", 20), flown("min-height", 20)})};
  const PapersShare share = papers_share(conditions);
  REQUIRE(share.conditions.size() == 1);
  REQUIRE(share.conditions[0].agents.size() == 1);
  CHECK(share.conditions[0].agents[0].name == "dqn");
  REQUIRE(share.left_out.size() == 3);
  CHECK_THAT(share.left_out[0], Contains("'random-walk' has 12 trials"));
  CHECK_THAT(share.left_out[1], Contains("no world with 3"));
  CHECK(share.left_out[2] == "test, a condition: 20 trials, at least 30 are needed");
}
