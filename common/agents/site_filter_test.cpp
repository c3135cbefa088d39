#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using namespace aloft::agents;
using aloft::flight::FlightRecord;
using nlohmann::json;

namespace {

std::unique_ptr<radio::SignalMap> generated(const json& given, std::uint32_t trial = 0) {
  const Parameters world = radio::resolve_generated_world(given, "world");
  return radio::make_generated_map(world, world::generate_city(world, 7, trial), 7, trial);
}

FlightRecord fly(const json& agent, const json& world, std::uint32_t trial = 0) {
  const AgentSpec spec = parse_agents(agent, "agents[0]").front();
  const auto map = generated(world, trial);
  return flight::fly(*map, 1, trial, *spec.make(), spec);
}

std::vector<double> heights(const FlightRecord& record) {
  std::vector<double> all;
  for (const flight::StepRecord& step : record.steps) all.push_back(step.height_m);
  return all;
}

/// Flies, and at this step goes on with a new agent that was restored from the state of the first.
std::vector<double> heights_if_restored(const json& world, std::uint32_t at) {
  const AgentSpec spec = parse_agents("site-filter", "agents[0]").front();
  const auto map = generated(world);
  auto agent = spec.make();
  flight::Flight flight(*map, 1, 0);
  agent->begin(flight.info());
  std::vector<double> all;
  while (true) {
    const std::uint32_t step = flight.observation().step;
    if (const auto survey = flight::survey(flight, Privilege::site_map, step == 0)) agent->survey(*survey);
    agent->observe(flight.observation());
    if (flight.finished()) return all;
    const Command command = agent->act();
    if (step == at) {
      auto fresh = spec.make();
      fresh->restore_state(agent->save_state());
      agent = std::move(fresh);
    }
    flight.step(command, "agent");
    all.push_back(flight.observation().height_m);
  }
}

}  // namespace

TEST_CASE("site-filter conforms") {
  flight::check_conformance("site-filter");
}

TEST_CASE("with an exact map, or where buildings often block, site-filter flies as site-planner") {
  for (const json& world :
       {json::object(), json{{"bs_density_per_km2", 5}, {"site_map_missing", 0.2}}, json{{"site_map_route_points", 5}},
        json{{"preset", "geometric"}, {"site_map_error_m", 25}}})
    CHECK(heights(fly("site-filter", world)) == heights(fly("site-planner", world)));
}

TEST_CASE("with a wrong map site-filter flies by what it learns") {
  const json wrong{{"site_map_error_m", 50}, {"bs_density_per_km2", 5}, {"steps", 60}};
  const json trusting{{"type", "site-planner"}, {"maps", 1}};
  double gain = 0.0;
  for (std::uint32_t trial = 0; trial < 5; ++trial)
    gain += fly("site-filter", wrong, trial).qos_mean() - fly(trusting, wrong, trial).qos_mean();
  INFO(gain / 5 << " bit/s/Hz");
  CHECK(gain / 5 > 2.0);  // 2.7 measured
  CHECK(heights(fly("site-filter", wrong)) == heights(fly("site-filter", wrong)));
}

TEST_CASE("cells that are not on the map are not learnt from") {
  const json gaps{{"site_map_error_m", 25}, {"site_map_missing", 0.9}, {"steps", 30}};
  CHECK(heights(fly("site-filter", gaps)) == heights(fly("site-filter", gaps)));
}

TEST_CASE("site-filter is restored in mid-flight, also with a route told in parts") {
  for (const json& world : {json{{"steps", 40}, {"site_map_error_m", 50}},
                            json{{"steps", 20}, {"site_map_route_points", 4}, {"site_map_error_m", 25}}}) {
    const std::vector<double> expected = heights(fly("site-filter", world));
    for (const std::uint32_t stop : {0U, 9U, 35U})
      if (stop < expected.size()) CHECK(heights_if_restored(world, stop) == expected);
  }
}

TEST_CASE("a route of which all is told in parts is flown by site-filter as a whole one") {
  const json whole{{"site_map_error_m", 25}, {"steps", 40}};
  json parts = whole;
  parts["site_map_route_points"] = 25;  // more than it plans ahead
  CHECK(heights(fly("site-filter", whole)) == heights(fly("site-filter", parts)));
}
