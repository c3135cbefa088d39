// Every agent over every channel model: legal commands, the same flight again, and the same flight when another object
// takes over from a saved state. The conformance kits check each alone.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/flight/flight.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/world/city.hpp"

using namespace aloft;

namespace {

constexpr std::uint64_t seed = 4;
constexpr std::uint32_t trial = 2;
constexpr std::uint32_t steps = 12;

/// All agents that can be made from their name alone; dqn with little training.
std::vector<agents::AgentSpec> all_agents() {
  std::vector<agents::AgentSpec> all;
  for (const agents::AgentType& type : agents::agent_types()) {
    if (type.foreign || type.relay) continue;
    nlohmann::json entry{{"type", type.name}};
    if (type.name == "dqn") entry.update({{"epochs", 2}, {"minibatch", 4}});
    all.push_back(agents::parse_agents(entry, "").front());
  }
  return all;
}

struct World {
  explicit World(const std::string& model)
      : parameters(radio::resolve_generated_world(
            {{"propagation", model}, {"steps", steps}, {"height_resolution_m", 10}}, "world")),
        city(world::generate_city(parameters, seed, trial)),
        map(radio::make_generated_map(parameters, city, seed, trial)) {}

  Parameters parameters;
  world::City city;
  std::unique_ptr<radio::SignalMap> map;
};

/// As flight::fly, but before each step from `relief` on another object goes on from the saved state of the one before.
flight::FlightRecord fly_in_turns(radio::SignalMap& map, const agents::AgentSpec& spec, std::uint32_t relief) {
  const agents::Privilege privilege = agents::agent_type(spec.type).privilege;
  flight::Flight flight(map, seed, trial);
  agents::HeightProfile buffer;
  auto agent = spec.make();
  agent->begin(flight.info());
  while (true) {
    if (const auto known = flight::survey(flight, privilege, flight.observation().step == 0)) agent->survey(*known);
    flight::foresee(flight, privilege, buffer, [&](const agents::HeightProfile& profile) { agent->foresee(profile); });
    agent->observe(flight.observation());
    if (flight.finished()) return std::move(flight).record();
    const agents::Command command = agent->act();
    if (flight.observation().step >= relief) {
      const std::string state = agent->save_state();
      agent = spec.make();
      agent->restore_state(state);
    }
    flight::execute(flight, command, spec);
  }
}

void check_legal(const flight::FlightRecord& record, const agents::AgentSpec& spec) {
  REQUIRE(record.steps.size() == steps);
  double before_m = record.height_start_m;
  for (const flight::StepRecord& step : record.steps) {
    CHECK((step.height_m >= 40.0 && step.height_m <= 240.0));
    if (!agents::agent_type(spec.type).unconstrained) CHECK(std::fabs(step.height_m - before_m) <= 10.0);
    CHECK((std::isfinite(step.qos) && step.qos >= 0.0));
    before_m = step.height_m;
  }
}

void check_equal(const flight::FlightRecord& a, const flight::FlightRecord& b) {
  REQUIRE(a.steps.size() == b.steps.size());
  for (std::size_t i = 0; i < a.steps.size(); ++i) {
    CHECK(a.steps[i].action == b.steps[i].action);
    CHECK(a.steps[i].height_m == b.steps[i].height_m);
    CHECK(a.steps[i].serving_cell == b.steps[i].serving_cell);
    CHECK(a.steps[i].qos == b.steps[i].qos);
  }
}

}  // namespace

TEST_CASE("agents keep their promises over every channel model") {
  const std::vector<agents::AgentSpec> agents = all_agents();
  CHECK(agents.size() > 10);
  CHECK(radio::link_model_types().size() >= 4);
  for (const radio::LinkModelType& model : radio::link_model_types()) {
    World world(model.name);
    World again(model.name);
    for (const agents::AgentSpec& spec : agents) {
      INFO(spec.name << " over " << model.name);
      const flight::FlightRecord record = flight::fly(*world.map, seed, trial, *spec.make(), spec);
      check_legal(record, spec);
      check_equal(record, flight::fly(*again.map, seed, trial, *spec.make(), spec));
      check_equal(record, fly_in_turns(*world.map, spec, steps / 2));
    }
  }
}

TEST_CASE("planner finds at least what every other constrained agent does, over every channel model") {
  const auto planner = agents::parse_agents("planner", "").front();
  for (const radio::LinkModelType& model : radio::link_model_types()) {
    World world(model.name);
    const double best = flight::fly(*world.map, seed, trial, *planner.make(), planner).qos_mean();
    for (const agents::AgentSpec& spec : all_agents()) {
      if (agents::agent_type(spec.type).unconstrained) continue;
      INFO(spec.name << " over " << model.name);
      CHECK(flight::fly(*world.map, seed, trial, *spec.make(), spec).qos_mean() <= best + 1e-12);
    }
  }
}
