#include "tools/report/published.hpp"

#include <catch2/catch.hpp>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using nlohmann::json;

TEST_CASE("A published value belongs to the condition with its densities or its flight", "[report]") {
  const json generated{{"bs_density_per_km2", 2.5}, {"building_density_per_km2", 200}};
  CHECK(belongs_to(generated, condition(2.5, 200, {})));
  CHECK_FALSE(belongs_to(generated, condition(2.5, 300, {})));
  ConditionTrials measured = condition(2.5, 200, {});
  measured.kind = aloft::experiment::WorldKind::measured;
  measured.experiment = "measured-gcq";
  CHECK_FALSE(belongs_to(generated, measured));
  CHECK(belongs_to(json{{"measured_flight", "GCQ"}}, measured));
  CHECK_FALSE(belongs_to(json{{"measured_flight", "NWQ"}}, measured));
  measured.measured_file = "nwq";
  CHECK(belongs_to(json{{"measured_flight", "NWQ"}}, measured));
}

TEST_CASE("Our mean, median and ratio of medians stand beside the published ones", "[report]") {
  const auto here =
      condition(1, 200,
                {agent("min-height", "min-height", {1.0, 4.0, 10.0}),
                 agent("constant-120", "constant", {2.0, 2.0, 2.0}), agent("dqn", "dqn", {9.0, 6.0, 3.0})});
  CHECK(beside_published(json{{"agent", "min-height"}, {"statistic", "mean"}}, here)["value"] == 5.0);
  CHECK(beside_published(json{{"agent", "min-height"}, {"statistic", "median"}}, here)["value"] == 4.0);
  // medians: dqn 6; min-height 4, constant-120 2, their mean 3
  const json ratio = beside_published(
      json{{"agent", "dqn"}, {"statistic", "ratio of medians"}, {"over", {"min-height", "constant-120"}}}, here);
  CHECK(ratio["value"] == 2.0);
  CHECK(ratio["ci95"][0].get<double>() <= 2.0);
  CHECK(ratio["ci95"][1].get<double>() >= 2.0);
  CHECK(beside_published(json{{"agent", "planner"}, {"statistic", "mean"}}, here).is_null());
  CHECK(beside_published(json{{"agent", "dqn"}, {"statistic", "ratio of medians"}, {"over", {"planner"}}}, here)
            .is_null());
}

TEST_CASE("The published set is complete and names agents as Aloft does", "[report]") {
  const json& values = published().at("values");
  const auto of_agent = [&](const char* name) {
    return std::count_if(values.begin(), values.end(), [&](const json& v) { return v["agent"] == name; });
  };
  CHECK(values.size() == 32);
  CHECK(of_agent("dqn") == 8);
  CHECK(of_agent("one-step-ahead") == 6);
  for (const json& value : values) CHECK(value["value"].get<double>() > 0.0);
}

TEST_CASE("A printed number is as exact as its last digit", "[report]") {
  CHECK(printed_tolerance(json{{"value", 68}}) == 0.5);
  CHECK(printed_tolerance(json{{"value", 18.5}}) == Approx(0.05));
  CHECK(printed_tolerance(json{{"value", 1.04}}) == Approx(0.005));
  CHECK(printed_tolerance(json{{"value", 70}, {"plus_minus", 2}}) == 2.0);
}
