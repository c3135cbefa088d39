#include "tools/compare/comparison.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

using aloft::compare::Comparison;
using aloft::compare::setting_differences;
using aloft::compare::Side;
using aloft::experiment::Experiment;
using aloft::store::FlightSummary;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// Agents named q plan the whole route.
Experiment experiment(const std::string& id, std::uint64_t seed, const std::vector<std::string>& conditions,
                      const std::vector<std::string>& agents) {
  Experiment made;
  made.id = id;
  made.seed = seed;
  for (const std::string& name : conditions) {
    auto& condition = made.conditions.emplace_back();
    condition.index = static_cast<std::uint32_t>(made.conditions.size() - 1);
    condition.name = name;
  }
  for (const std::string& name : agents) made.agents.push_back({name, name == "q" ? "planner" : "min-height", {}, {}});
  return made;
}

FlightSummary flight(std::uint32_t condition, std::uint32_t trial, const std::string& agent, double qos,
                     const std::string& digest) {
  FlightSummary made{{condition, trial, agent}, {}, digest};
  made.metrics[aloft::flight::quality] = qos;
  return made;
}

}  // namespace

TEST_CASE("flights are paired by trial; means, differences and identical flights are counted") {
  const Experiment same = experiment("x", 1, {"c"}, {"p", "q"});
  const Comparison comparison = compare(
      Side{
          same,
          {flight(0, 0, "p", 1, "a"), flight(0, 1, "p", 2, "b"), flight(0, 2, "p", 6, "c"), flight(0, 0, "q", 5, "d")}},
      Side{same, {flight(0, 0, "p", 1, "a"), flight(0, 1, "p", 5, "B"), flight(0, 0, "q", 5, "d")}});
  CHECK(comparison.same_experiment);
  CHECK(comparison.agents[0].privilege == aloft::agents::Privilege::none);
  CHECK(comparison.agents[1].privilege == aloft::agents::Privilege::whole_route);
  CHECK(comparison.paired);
  REQUIRE(comparison.agents.size() == 2);
  const auto& p = comparison.agents[0];
  CHECK(p.agent == "p");
  CHECK(p.flights_a == 2);
  CHECK(p.in_both == 2);
  CHECK(p.identical == 1);
  CHECK(p.qos_mean_a == 1.5);  // trial 2 is in A alone
  CHECK(p.qos_mean_b == 3.0);
  CHECK(p.difference == 1.5);
  REQUIRE(p.difference_ci95);
  CHECK(p.difference_ci95->low == 0.0);  // two differences, 0 and 3: a quarter of the resamples has only the one
  CHECK(p.difference_ci95->high == 3.0);
  CHECK_FALSE(comparison.agents[1].difference_ci95);
  CHECK(comparison.in_both == 3);
  CHECK(comparison.identical == 2);
  CHECK(comparison.only_a == 1);
  CHECK(comparison.only_b == 0);
  CHECK_FALSE(comparison.all_identical());
  REQUIRE(comparison.first_different);
  CHECK(comparison.first_different->a.trial == 1);
}

TEST_CASE("equal flights on both sides are identical, and a difference of 0 that never varies has no interval") {
  const Experiment same = experiment("x", 1, {"c"}, {"p"});
  const std::vector<FlightSummary> flights{flight(0, 0, "p", 1, "a"), flight(0, 1, "p", 2, "b")};
  const Comparison comparison = compare(Side{same, flights}, Side{same, flights});
  CHECK(comparison.all_identical());
  CHECK(comparison.agents[0].difference == 0.0);
  CHECK_FALSE(comparison.agents[0].difference_ci95);
  CHECK_FALSE(comparison.first_different);
}

TEST_CASE("two experiments are compared where conditions and agents have the same names") {
  const Experiment a = experiment("x", 1, {"c", "d"}, {"p", "q"});
  const Experiment b = experiment("y", 1, {"e", "d"}, {"q", "p"});
  const Comparison comparison =
      compare(Side{a, {flight(0, 0, "p", 1, "a"), flight(1, 0, "p", 2, "b"), flight(1, 1, "q", 4, "c")}},
              Side{b, {flight(0, 0, "p", 1, "a"), flight(1, 0, "p", 7, "b"), flight(1, 2, "q", 4, "c")}});
  CHECK_FALSE(comparison.same_experiment);
  REQUIRE(comparison.agents.size() == 1);  // q has no trial in common
  CHECK(comparison.agents[0].condition == "d");
  CHECK(comparison.agents[0].difference == 5.0);
  CHECK(comparison.only_a == 2);
  CHECK(comparison.only_b == 2);
}

TEST_CASE("with different seeds the means of all flights are compared") {
  const Experiment a = experiment("x", 1, {"c"}, {"p"});
  const Experiment b = experiment("y", 2, {"c"}, {"p"});
  std::vector<FlightSummary> flights_a;
  std::vector<FlightSummary> flights_b;
  for (std::uint32_t trial = 0; trial < 400; ++trial) flights_a.push_back(flight(0, trial, "p", trial % 2, "a"));
  for (std::uint32_t trial = 0; trial < 100; ++trial)
    flights_b.push_back(flight(0, trial, "p", 10 + 2 * (trial % 2), "b"));
  const Comparison comparison = compare(Side{a, flights_a}, Side{b, flights_b});
  CHECK_FALSE(comparison.paired);
  const auto& row = comparison.agents.at(0);
  CHECK(row.flights_a == 400);
  CHECK(row.flights_b == 100);
  CHECK(row.difference == 10.5);
  // Standard errors 0.5 / sqrt(400) = 0.025 and 1 / sqrt(100) = 0.1: 1.96 x sqrt(0.025^2 + 0.1^2) = 0.202.
  CHECK(row.difference_ci95->low == Approx(10.5 - 0.202).margin(0.02));
  CHECK(row.difference_ci95->high == Approx(10.5 + 0.202).margin(0.02));
}

TEST_CASE("nothing shared is refused, with what each side has") {
  const Experiment a = experiment("x", 1, {"c"}, {"p"});
  const Experiment b = experiment("y", 1, {"d"}, {"p"});
  const auto comparing = [](const Experiment& left, const Experiment& right) {
    return compare(Side{left, {flight(0, 0, "p", 1, "a")}}, Side{right, {flight(0, 0, "p", 1, "a")}});
  };
  CHECK_THROWS_AS(comparing(a, b), aloft::InputError);
  CHECK_THROWS_WITH(comparing(a, b), Contains("conditions c; agents p") && Contains("conditions d"));
  Experiment measured = a;
  measured.conditions[0].kind = aloft::experiment::WorldKind::measured;
  CHECK_THROWS_AS(comparing(a, measured), aloft::InputError);
}

TEST_CASE("settings that differ are named with both values") {
  Experiment a;
  Experiment b;
  const auto settings = [](const char* los_ray, std::vector<Json> agents) {
    return Json{{"seed", 1}, {"worlds", {{{"los_ray", los_ray}}}}, {"agents", std::move(agents)}};
  };
  const Json p{{"type", "min-height"}, {"name", "p"}};
  const Json q{{"type", "min-height"}, {"name", "q"}};
  a.canonical = settings("published", {p});
  b.canonical = settings("geometric", {p, q});
  const auto differences = setting_differences(a, b, 10);
  REQUIRE(differences.size() == 2);
  CHECK(differences[0].path == "/agents/-");
  CHECK(differences[0].a == "-");
  CHECK(differences[0].b == q.dump());
  CHECK(differences[1].path == "/worlds/0/los_ray");
  CHECK(differences[1].a == "\"published\"");
  CHECK(differences[1].b == "\"geometric\"");
  CHECK(setting_differences(a, b, 1).size() == 1);
  CHECK(setting_differences(a, a, 10).empty());
}

TEST_CASE("where files lie is no setting, what they hold is") {
  const auto settings = [](const std::string& clone, const std::string& sha256) {
    const Json trained{{"type", "pretrained"}, {"name", "p"}, {"model", clone + "/model.pb"}, {"model_sha256", sha256}};
    Experiment experiment;
    experiment.canonical = {
        {"description", "in " + clone},
        {"energy_weight", 0},
        {"worlds", {{{"kind", "measured"}, {"name", "grid"}, {"file", clone + "/grid.csv"}, {"file_sha256", "1"}}}},
        {"agents", {trained, {{"type", "relay"}, {"name", "r"}, {"crew", {{{"agent", trained}}}}}}}};
    return experiment;
  };
  CHECK(setting_differences(settings("/home/a", "2"), settings("/home/b", "2"), 10).empty());
  const auto differences = setting_differences(settings("/home/a", "2"), settings("/home/b", "3"), 10);
  REQUIRE(differences.size() == 2);
  CHECK(differences[0].path == "/agents/0/model_sha256");
  CHECK(differences[1].path == "/agents/1/crew/0/agent/model_sha256");
  Experiment weighted = settings("/home/a", "2");
  weighted.canonical["energy_weight"] = 1;
  CHECK(setting_differences(settings("/home/a", "2"), weighted, 10).front().a == "0");  // defaults are shown, too
}
