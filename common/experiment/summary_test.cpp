#include "common/experiment/summary.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

using namespace aloft;
using namespace aloft::experiment;
using Catch::Contains;
using OrderedJson = nlohmann::ordered_json;

namespace {

Experiment two_conditions() {
  Experiment experiment;
  experiment.name = "hand-made";
  experiment.id = "0123456789abcdef";
  experiment.seed = 18446744073709551615U;
  experiment.trials = 4;
  experiment.conditions.push_back({0, "bs_density_per_km2=1", {{"bs_density_per_km2", 1}}, WorldKind::generated, {}});
  experiment.conditions.push_back({1, "canal, \"real\"", nlohmann::json::object(), WorldKind::measured, {}});
  experiment.agents.push_back({"dqn", "dqn", {}, {}});
  experiment.agents.push_back({"min-height", "min-height", {}, {}});
  return experiment;
}

FlightSummary flown(FlightKey key, double qos_mean, double height_mean_m, double height_changes, double energy_j = 0.0,
                    std::optional<double> handovers = {}) {
  FlightSummary flight{std::move(key)};
  flight.metrics[flight::metric_index("qos_mean")] = qos_mean;
  flight.metrics[flight::metric_index("height_mean_m")] = height_mean_m;
  flight.metrics[flight::metric_index("height_changes")] = height_changes;
  flight.metrics[flight::metric_index("energy_j")] = energy_j;
  flight.metrics[flight::metric_index("handovers")] = handovers;
  return flight;
}

std::vector<FlightSummary> some_flights() {
  return {flown({0, 0, "dqn"}, 5.0, 60.0, 10, 15e3, 4),    flown({0, 0, "min-height"}, 4.0, 40.0, 0),
          flown({0, 1, "dqn"}, 9.0, 80.0, 20, 16e3, 5),    flown({0, 1, "min-height"}, 6.0, 40.0, 0),
          flown({0, 2, "dqn"}, 100.0, 100.0, 30, 20e3, 9),  // whose min-height flight is missing
          flown({0, 3, "min-height"}, 1000.0, 40.0, 0),    flown({1, 0, "dqn"}, 41234.0, 60.0, 1, 21e3)};
}

}  // namespace

TEST_CASE("a summary gives every statistic of every agent, by hand") {
  const OrderedJson summary = summarise(two_conditions(), some_flights(), "1.2.3");
  CHECK(summary["experiment"] == "hand-made");
  CHECK(summary["experiment_id"] == "0123456789abcdef");
  CHECK(summary["seed"] == 18446744073709551615U);
  CHECK(summary["build"] == "1.2.3");
  CHECK(summary["qos_unit"].is_null());
  REQUIRE(summary["conditions"].size() == 2);
  const OrderedJson& condition = summary["conditions"][0];
  CHECK(condition["name"] == "bs_density_per_km2=1");
  CHECK(condition["qos_unit"] == "bit/s/Hz");
  CHECK(condition["parameters"]["kind"] == "generated");
  CHECK(condition["agents"].begin().key() == "dqn");  // the experiment's order

  const OrderedJson& dqn = condition["agents"]["dqn"];
  CHECK(dqn["trials"] == 3);
  CHECK(dqn["qos_mean"].get<double>() == Approx(38.0));
  CHECK(dqn["qos_median"] == 9.0);
  CHECK(dqn["qos_q25"] == 7.0);
  CHECK(dqn["qos_q75"] == 54.5);
  CHECK(dqn["height_mean_m"] == 80.0);
  CHECK(dqn["height_changes_mean"] == 20.0);
  CHECK(dqn["energy_mean_j"] == 17e3);
  CHECK(dqn["handovers_mean"] == 6.0);
  CHECK(dqn["qos_ci95"][0] == 5.0);  // 27 resamples, each extreme has 1/27 > 2.5 %
  CHECK(dqn["qos_ci95"][1] == 100.0);
  // Paired on trials 0 and 1 alone: gains 1 and 3.
  CHECK(dqn["gain_over_min_height_mean"] == 2.0);
  CHECK(dqn["gain_over_min_height_ci95"] == OrderedJson::array({1.0, 3.0}));
}

TEST_CASE("min-height gains 0 over itself in every trial, so there is no interval") {
  const OrderedJson summary = summarise(two_conditions(), some_flights(), "");
  const OrderedJson& agent = summary["conditions"][0]["agents"]["min-height"];
  CHECK(agent["gain_over_min_height_mean"] == 0.0);
  CHECK(agent["gain_over_min_height_ci95"].is_null());
}

TEST_CASE("what was not flown is null, never zero") {
  const OrderedJson summary = summarise(two_conditions(), some_flights(), "");
  const OrderedJson& measured = summary["conditions"][1];
  CHECK(measured["qos_unit"] == "kbit/s");
  const OrderedJson& missing = measured["agents"]["min-height"];
  CHECK(missing["trials"] == 0);
  CHECK(missing["qos_mean"].is_null());
  CHECK(missing["qos_ci95"].is_null());
  CHECK(measured["agents"]["dqn"]["handovers_mean"].is_null());  // the cells are unknown
  CHECK(measured["agents"]["dqn"]["gain_over_min_height_mean"].is_null());
  CHECK(measured["agents"]["dqn"]["gain_over_min_height_ci95"].is_null());
}

TEST_CASE("with one trial there is no interval: null, an empty cell, a dash") {
  Experiment experiment = two_conditions();
  experiment.conditions.pop_back();
  const std::vector<FlightSummary> flights{flown({0, 0, "dqn"}, 5.0, 60.0, 10, 15e3, 4),
                                           flown({0, 0, "min-height"}, 4.0, 40.0, 0)};
  const OrderedJson summary = summarise(experiment, flights, "");
  for (const OrderedJson& agent : summary["conditions"][0]["agents"]) {
    CHECK(agent["qos_ci95"].is_null());
    CHECK(agent["gain_over_min_height_ci95"].is_null());
  }
  CHECK_THAT(summary_csv(summary), Contains(",dqn,none,bit/s/Hz,1,5.0,,,5.0,") && Contains(",1.0,,\n"));
  const std::string table = summary_table(summary);
  CHECK_THAT(table, Contains("+1.00\n") && Contains("No interval: there is one flight"));
  CHECK_THAT(table.substr(table.find('\n')), !Contains("5.00, 5.00") && !Contains("[1.00") && !Contains("nan"));
}

TEST_CASE("the same value in every trial has no interval") {
  Experiment experiment = two_conditions();
  experiment.conditions.erase(experiment.conditions.begin());
  experiment.conditions[0].index = 0;
  std::vector<FlightSummary> flights;
  for (std::uint32_t trial = 0; trial < 4; ++trial) {
    flights.push_back(flown({0, trial, "dqn"}, 30e3 + trial, 60.0, 10, 15e3));
    flights.push_back(flown({0, trial, "min-height"}, 20e3, 40.0, 0));
  }
  const OrderedJson summary = summarise(experiment, flights, "");
  CHECK(summary["conditions"][0]["agents"]["min-height"]["qos_ci95"].is_null());
  CHECK(summary["conditions"][0]["agents"]["dqn"]["qos_ci95"].is_array());
  CHECK(summary["conditions"][0]["agents"]["dqn"]["gain_over_min_height_ci95"].is_array());
}

TEST_CASE("every agent carries its tier of privilege") {
  Experiment experiment = two_conditions();
  experiment.agents.push_back({"ahead", "one-step-ahead", {}, {}});
  experiment.agents.push_back({"planner", "planner", {}, {}});
  agents::AgentSpec relay{"both", "relay", {}, {}};  // an experiment file must not have such a relay
  relay.crew.push_back({{"a", "min-height", {}, {}}, 1, true});
  relay.crew.push_back({{"b", "planner", {}, {}}, 51, true});
  experiment.agents.push_back(relay);
  const OrderedJson summary = summarise(experiment, {}, "");
  const OrderedJson& agents = summary["conditions"][0]["agents"];
  CHECK(agents["dqn"]["privilege"] == "none");
  CHECK(agents["ahead"]["privilege"] == "next-step");
  CHECK(agents["planner"]["privilege"] == "whole-route");
  CHECK(agents["both"]["privilege"] == "whole-route");
  CHECK_THAT(summary_csv(summary), Contains(",planner,whole-route,bit/s/Hz,0,"));
  CHECK_THAT(summary_table(summary),
             Contains("  ahead *  ") && Contains("  planner **  ") && Contains("  both **  ") && Contains("  dqn  ") &&
                 Contains("* sees the next step at every height, ** sees the whole route at every height."));
}

TEST_CASE("a unit that all conditions share is given at the top") {
  Experiment experiment = two_conditions();
  experiment.conditions.pop_back();
  CHECK(summarise(experiment, {}, "")["qos_unit"] == "bit/s/Hz");
}

TEST_CASE("the CSV has one line per condition and agent") {
  const std::string csv = summary_csv(summarise(two_conditions(), some_flights(), ""));
  CHECK(csv.starts_with("condition,agent,privilege,qos_unit,trials,qos_mean,qos_ci95_low,qos_ci95_high,qos_median,"));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 5);
  CHECK_THAT(csv, Contains("\nbs_density_per_km2=1,min-height,none,bit/s/Hz,3,"));
  CHECK_THAT(csv, Contains("\n\"canal, \"\"real\"\"\",dqn,none,kbit/s,1,41234.0,,,41234.0,"));
  CHECK_THAT(csv, Contains("kbit/s,0,,,,,,,,,,,,,,,,\n"));
}

TEST_CASE("the table shows throughput in Mbit/s and aligns its columns") {
  const std::string table = summary_table(summarise(two_conditions(), some_flights(), ""));
  CHECK_THAT(table, Contains("Mbit/s") && Contains("bit/s/Hz") && Contains("41.23") && Contains("+2.00 [1.00, 3.00]"));
  const auto header = table.find("agent ");
  const auto first = table.find("\n", header);
  const auto second = table.find("\n", first + 1);
  CHECK(second - first == table.find("\n", second + 1) - second);
}

TEST_CASE("the table fits the terminal: less important columns are left out and named, the same in all conditions") {
  const OrderedJson summary = summarise(two_conditions(), some_flights(), "");
  const auto lines = [](const std::string& text) {
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) all.push_back(line);
    return all;
  };
  CHECK_THAT(summary_table(summary), Contains("[quartiles]") && !Contains("--wide"));
  for (const std::size_t width : {60U, 80U, 110U}) {
    const std::string table = summary_table(summary, {.width = width});
    INFO(table);
    for (const std::string& line : lines(table)) CHECK(display_width(line) <= width);
    CHECK_THAT(table, Contains("gain over min-height") && Contains("Left out to fit") && Contains("--wide"));
    CHECK_THAT(table.substr(0, table.find("Left out")), !Contains("[quartiles]"));
  }
  const std::string brief = summary_table(summary, {.brief = true});
  CHECK_THAT(brief,
             Contains("agent") && Contains("gain over min-height") && !Contains("height m") && !Contains("Left out"));
}
