#include "tools/report/published.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::experiment::Interval;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using Catch::Contains;
using nlohmann::json;

namespace {

/// Each of these values ten times.
std::vector<double> ten_times(std::initializer_list<double> values) {
  std::vector<double> result;
  for (int i = 0; i < 10; ++i) result.insert(result.end(), values);
  return result;
}

json value(const char* agent, const char* statistic, int published) {
  return {{"bs_density_per_km2", 1},
          {"building_density_per_km2", 200},
          {"agent", agent},
          {"statistic", statistic},
          {"value", published}};
}

}  // namespace

TEST_CASE("A published value belongs to the condition with its densities, or to its very flight", "[report]") {
  const json generated{{"bs_density_per_km2", 2.5}, {"building_density_per_km2", 200}};
  CHECK(belongs_to(generated, condition(2.5, 200, {})));
  CHECK_FALSE(belongs_to(generated, condition(2.5, 300, {})));
  ConditionTrials measured = condition(2.5, 200, {});
  measured.kind = aloft::experiment::WorldKind::measured;
  measured.experiment = measured.measured_file = "gcq";
  measured.world_parameters = {{"file_sha256", "0123"}};
  CHECK_FALSE(belongs_to(generated, measured));
  CHECK_FALSE(belongs_to(json{{"measured_flight", "GCQ"}}, measured));
  measured.world_parameters = {{"file_sha256", published().at("measured_flights").at("GCQ").at("sha256")}};
  CHECK(belongs_to(json{{"measured_flight", "GCQ"}}, measured));
  CHECK_FALSE(belongs_to(json{{"measured_flight", "NWQ"}}, measured));
}

TEST_CASE("A value agrees only with an interval narrow enough to disagree", "[report]") {
  const Interval none{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  CHECK(agreement(20, 0.5, 13.26, {5.1, 20.4}) == Agreement::undecided);
  CHECK(agreement(20, 0.5, 20.0, {19.4, 20.6}) == Agreement::undecided);
  CHECK(agreement(20, 0.5, 20.1, {19.6, 20.5}) == Agreement::agrees);
  CHECK(agreement(20, 0.5, 13.26, {12.9, 13.6}) == Agreement::disagrees);
  CHECK(agreement(68, 0.5, 68.2, none) == Agreement::agrees);  // exact: the same in every trial
  CHECK(agreement(68, 0.5, 80.1, none) == Agreement::disagrees);
}

TEST_CASE("Our mean, median and ratio of medians stand beside the published ones", "[report]") {
  const auto here = condition(
      1, 200,
      {agent("min-height", "min-height", ten_times({1.0, 4.0, 10.0})),
       agent("constant-120", "constant", ten_times({2.0, 2.0, 2.0})), agent("dqn", "dqn", ten_times({9.0, 6.0, 3.0}))});
  CHECK(beside_published(value("min-height", "mean", 5), here)["value"].get<double>() == Approx(5.0));
  CHECK(beside_published(value("min-height", "median", 4), here)["value"] == 4.0);
  CHECK(beside_published(value("constant-120", "median", 2), here) ==
        json{{"verdict", "agrees"}, {"reason", ""}, {"value", 2.0}, {"ci95", nullptr}, {"trials", 30}});
  // medians: dqn 6; min-height 4, constant-120 2, their mean 3
  json over = value("dqn", "ratio of medians", 2);
  over["over"] = {"min-height", "constant-120"};
  const json ratio = beside_published(over, here);
  CHECK(ratio["value"] == 2.0);
  CHECK(ratio["ci95"][0].get<double>() <= 2.0);
  CHECK(ratio["ci95"][1].get<double>() >= 2.0);
  CHECK(beside_published(value("optimal-height", "mean", 5), here).is_null());
  over["over"] = {"random-walk"};
  CHECK(beside_published(over, here).is_null());
}

TEST_CASE("A verdict that cannot be given says why", "[report]") {
  // mean 5, standard deviation 4.2 / sqrt(30): an interval of about +-1.3
  auto here = condition(1, 200, {agent("min-height", "min-height", ten_times({1.0, 4.0, 10.0}))});
  json beside = beside_published(value("min-height", "mean", 5), here);
  CHECK(beside["verdict"] == "undecided");
  CHECK_THAT(beside["reason"].get<std::string>(), Contains("good to ± 0.5; it takes about 2"));
  here.agents[0].parameters["unknown"] = 1;
  beside = beside_published(value("min-height", "mean", 5), here);
  CHECK(beside["verdict"] == "not-applicable");
  CHECK(beside["value"].is_null());
  here = condition(1, 200, {agent("min-height", "min-height", std::vector<double>(29, 20.0))});
  beside = beside_published(value("min-height", "mean", 20), here);
  CHECK(beside["verdict"] == "not-applicable");
  CHECK_THAT(beside["reason"].get<std::string>(), Contains("29 trials, at least 30 are needed"));
}

TEST_CASE("The published set is complete and names agents as Aloft does", "[report]") {
  const json& values = published().at("values");
  const auto of_agent = [&](const char* name) {
    return std::count_if(values.begin(), values.end(), [&](const json& v) { return v["agent"] == name; });
  };
  CHECK(values.size() == 32);
  CHECK(of_agent("dqn") == 8);
  CHECK(of_agent("one-step-ahead") == 6);
  for (const json& value : values) {
    CHECK(value["value"].get<double>() > 0.0);
    CHECK(published().at("agents").contains(value["agent"].get<std::string>()));
  }
  for (const json& claim : published().at("claims"))
    for (const json& name : claim.at("agents")) CHECK(published().at("agents").contains(name.get<std::string>()));
}

TEST_CASE("A printed number is as exact as its last digit", "[report]") {
  CHECK(printed_tolerance(json{{"value", 68}}) == 0.5);
  CHECK(printed_tolerance(json{{"value", 18.5}}) == Approx(0.05));
  CHECK(printed_tolerance(json{{"value", 1.04}}) == Approx(0.005));
  CHECK(printed_tolerance(json{{"value", 70}, {"plus_minus", 2}}) == 2.0);
}
