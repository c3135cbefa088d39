#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"
#include "common/radio/expected_field.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using namespace aloft::agents;
using aloft::flight::FlightRecord;
using aloft::flight::SyntheticMap;
using nlohmann::json;

namespace {

AgentSpec planner(const json& entry = "site-planner") {
  return parse_agents(entry, "agents[0]").front();
}

FlightRecord fly(radio::SignalMap& map, const AgentSpec& spec = planner()) {
  return flight::fly(map, 1, 0, *spec.make(), spec);
}

/// Column of step j at [j - 1].
std::vector<std::vector<double>> expected_columns(radio::SignalMap& map) {
  radio::ExpectedField field(map.survey()->radio, map.survey()->map.sites);
  std::vector<std::vector<double>> columns(map.steps(), std::vector<double>(field.levels()));
  for (std::uint32_t step = 1; step <= map.steps(); ++step)
    field.column(map.advance(map.result_point(step), map.start(), -1), columns[step - 1].data());
  return columns;
}

/// The best sum of expectations from `level` after `step` steps over `horizon` steps, by trying all actions.
double best_sum(const std::vector<std::vector<double>>& columns, std::size_t step, int level, std::size_t horizon) {
  if (step == columns.size() || horizon == 0) return 0.0;
  double best = -1.0;
  for (int to = std::max(level - 1, 0); to <= std::min(level + 1, static_cast<int>(columns[step].size()) - 1); ++to)
    best = std::max(best, columns[step][static_cast<std::size_t>(to)] + best_sum(columns, step + 1, to, horizon - 1));
  return best;
}

std::unique_ptr<radio::SignalMap> generated(const json& given, std::uint32_t trial = 0) {
  const Parameters world = radio::resolve_generated_world(given, "world");
  return radio::make_generated_map(world, world::generate_city(world, 7, trial), 7, trial);
}

/// Different for most pairs of different flights.
double level_sum(const FlightRecord& record) {
  double sum = 0.0;
  for (const flight::StepRecord& step : record.steps) sum += step.height_m * step.step;
  return sum;
}

int level_of(const flight::StepRecord& step) {
  return static_cast<int>((step.height_m - 40.0) / 10.0 + 0.5);
}

}  // namespace

TEST_CASE("site-planner conforms") {
  flight::check_conformance("site-planner");
}

TEST_CASE("site-planner flies the best of all flights through what is to be expected") {
  for (std::uint32_t levels = 2; levels <= 5; ++levels) {
    SyntheticMap map = SyntheticMap::random(QosKind::spectral_efficiency, 8, levels, levels);
    const auto columns = expected_columns(map);
    double sum = 0.0;
    for (const flight::StepRecord& step : fly(map).steps)
      sum += columns[step.step - 1][static_cast<std::size_t>(level_of(step))];
    CHECK(sum == Approx(best_sum(columns, 0, 0, columns.size())).epsilon(1e-12));
  }
}

TEST_CASE("site-planner holds where nothing is to be expected") {
  SyntheticMap synthetic = SyntheticMap::random(QosKind::spectral_efficiency, 8, 4, 1);
  const AgentSpec spec = planner();
  const auto agent = spec.make();
  flight::Flight flight(synthetic, 1, 0);
  agent->begin(flight.info());
  SiteMap nothing = flight.site_map(false);
  nothing.known.sites.clear();
  agent->survey(nothing);
  agent->observe(flight.observation());
  CHECK(agent->act().action == Action::hold);
}

TEST_CASE("a route told in parts: each step is the first of the best flight as far as the route is known") {
  for (const int told : {1, 3, 6}) {
    const auto map = generated({{"site_map_route_points", told}, {"steps", 12}, {"height_max_m", 70}});
    REQUIRE(map->survey()->map.route_points == static_cast<std::uint32_t>(told));
    const auto columns = expected_columns(*map);
    int level = 0;
    for (const flight::StepRecord& step : fly(*map).steps) {
      const int to = level_of(step);
      INFO("told " << told << ", step " << step.step);
      const auto horizon = static_cast<std::size_t>(told);
      CHECK(columns[step.step - 1][static_cast<std::size_t>(to)] + best_sum(columns, step.step, to, horizon - 1) ==
            Approx(best_sum(columns, step.step - 1, level, horizon)).epsilon(1e-12));
      level = to;
    }
  }
}

TEST_CASE("a route of which all is told in parts is flown as a whole one") {
  const auto whole = fly(*generated(json::object()));
  const auto parts = fly(*generated({{"site_map_route_points", 100}}));
  REQUIRE(whole.steps.size() == parts.steps.size());
  for (std::size_t i = 0; i < whole.steps.size(); ++i) CHECK(whole.steps[i].height_m == parts.steps[i].height_m);
}

TEST_CASE("a stated error is averaged over maps drawn anew, by the flight's seed") {
  const json wrong{{"site_map_error_m", 25}};
  const auto heights = [](const FlightRecord& record) {
    std::vector<double> all;
    for (const flight::StepRecord& step : record.steps) all.push_back(step.height_m);
    return all;
  };
  CHECK(heights(fly(*generated(wrong))) == heights(fly(*generated(wrong))));
  CHECK(heights(fly(*generated(wrong), planner({{"type", "site-planner"}, {"maps", 1}}))) !=
        heights(fly(*generated(wrong), planner({{"type", "site-planner"}, {"maps", 64}}))));
  CHECK(heights(fly(*generated(json::object()), planner({{"type", "site-planner"}, {"maps", 1}}))) ==
        heights(fly(*generated(json::object()))));
}

TEST_CASE("with a wrong map site-planner weighs the maps by its reports") {
  const json wrong{{"site_map_error_m", 50}, {"bs_density_per_km2", 5}};
  double gain = 0.0;
  for (std::uint32_t trial = 0; trial < 5; ++trial)
    gain += fly(*generated(wrong, trial)).qos_mean() -
            fly(*generated(wrong, trial), planner({{"type", "site-planner"}, {"maps", 1}})).qos_mean();
  INFO(gain / 5 << " bit/s/Hz");
  CHECK(gain / 5 > 2.5);  // 3.1 measured
}

TEST_CASE("stations that the map lacks are drawn, and buildings where they often block the view") {
  const auto differ = [](const json& given, const json& one, const json& other) {
    return level_sum(fly(*generated(given), planner(one))) != level_sum(fly(*generated(given), planner(other)));
  };
  const json one_map{{"type", "site-planner"}, {"maps", 1}};
  const json unblocked{{"type", "site-planner"}, {"ignored_blocking", 1}};
  CHECK(differ({{"site_map_missing", 0.3}}, one_map, "site-planner"));
  CHECK(differ({{"preset", "geometric"}}, unblocked, "site-planner"));
  CHECK_FALSE(differ(json::object(), unblocked, "site-planner"));  // published: few links are blocked
  CHECK(differ(json::object(), {{"type", "site-planner"}, {"ignored_blocking", 0}}, "site-planner"));
}

TEST_CASE("site-planner is restored in mid-flight, also with a route told in parts") {
  for (const json& given :
       {json{{"steps", 20}}, json{{"steps", 20}, {"site_map_route_points", 4}, {"site_map_error_m", 25}},
        json{{"steps", 20}, {"site_map_route_points", 4}, {"site_map_missing", 0.4}, {"preset", "geometric"}}}) {
    const auto map = generated(given);
    const AgentSpec spec = planner();
    const FlightRecord expected = fly(*map);
    for (std::uint32_t stop = 0; stop < 20; stop += 3) {
      auto agent = spec.make();
      flight::Flight flight(*map, 1, 0);
      agent->begin(flight.info());
      while (true) {
        const std::uint32_t step = flight.observation().step;
        if (const auto survey = flight::survey(flight, Privilege::site_map, step == 0)) agent->survey(*survey);
        agent->observe(flight.observation());
        if (flight.finished()) break;
        const Command command = agent->act();
        if (step == stop) {
          auto fresh = spec.make();
          fresh->restore_state(agent->save_state());
          agent = std::move(fresh);
        }
        flight.step(command, "agent");
        CHECK(flight.observation().height_m == expected.steps.at(step).height_m);
      }
    }
  }
}

TEST_CASE("without a map, or the route ahead, site-planner says what is missing") {
  const AgentSpec spec = planner();
  const auto agent = spec.make();
  agent->begin({.height_min_m = 40, .height_max_m = 60, .height_step_m = 10, .steps = 4});
  agent->observe({.height_m = 40});
  CHECK_THROWS_WITH(agent->act(), "site-planner was not told the route ahead");
  const auto swerving = generated({{"route", "serving"}});
  CHECK_THROWS_AS(fly(*swerving), InputError);
}
