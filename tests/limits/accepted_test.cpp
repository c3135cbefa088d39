// Every process can send what an accepted experiment needs: such experiments are flown sample by sample, each checked
// as the bus checks it, and give the same bytes as a direct call.
#include <rapidcheck.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/bus/convert.hpp"
#include "common/bus/validate.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/measured_map.hpp"
#include "common/radio/scene.hpp"
#include "common/store/result_store.hpp"
#include "common/world/city.hpp"
#include "common/world/measured_flight.hpp"
#include "tests/integration/command.hpp"
#include "tests/limits/random_experiment.hpp"

namespace aloft {
namespace {

/// Checks a sample as bus::Writer and bus::Reader would.
template <class T>
void check_sample(const T& sample) {
  if (const char* error = bus::validate(sample)) throw std::runtime_error(error);
}

wire::World world_sample(const experiment::Experiment& experiment, const experiment::Condition& condition) {
  wire::World world;
  std::vector<std::string> agents;
  for (const agents::AgentSpec& spec : experiment.agents) agents.push_back(spec.name);
  world.agents(wire::names(agents));
  std::visit([&](const auto& made) { bus::put(world, made); }, experiment::make_world(experiment, condition, 0));
  return world;
}

std::unique_ptr<radio::SignalMap> map_of(const experiment::Experiment& experiment,
                                         const experiment::Condition& condition, const wire::World& world) {
  if (condition.kind == experiment::WorldKind::measured) {
    const world::MeasuredWorld measured = bus::measured_world(world);
    return radio::make_measured_map(measured.flight, measured.known);
  }
  return radio::make_generated_map(condition.world, bus::city(world), experiment.seed, 0);
}

/// One flight in which every message is encoded and decoded.
flight::FlightRecord fly_by_samples(radio::SignalMap& map, std::uint64_t seed, const agents::AgentSpec& spec,
                                    const flight::Costs& costs) {
  flight::Flight flight(map, seed, 0, costs);
  wire::ChannelReport report;
  report.agent(wire::name(spec.name));
  bus::put(report, flight.info());
  const std::unique_ptr<agents::Agent> agent = spec.make();
  agent->begin(bus::flight_info(report));
  agents::HeightProfile buffer;
  while (true) {
    const bool first = flight.observation().step == 0;
    if (const auto known = flight::survey(flight, agents::agent_type(spec.type).privilege, first)) {
      wire::SiteMap sample;
      bus::put(sample, *known);
      check_sample(sample);
      agent->survey(bus::site_map(sample));
    }
    flight::foresee(flight, agents::agent_type(spec.type).privilege, buffer, [&](const agents::HeightProfile& profile) {
      wire::HeightProfile sample;
      bus::put(sample, profile);
      check_sample(sample);
      agent->foresee(bus::profile(sample));
    });
    bus::put(report, flight.observation());
    check_sample(report);
    agent->observe(bus::observation(report));
    if (flight.finished()) return std::move(flight).record();
    wire::HeightCommand command;
    command.agent(wire::name(spec.name));
    command.step(report.step() + 1);
    bus::put(command, agent->act());
    check_sample(command);
    flight.step(bus::command(command), spec.name);
  }
}

/// Checks the samples of a world that takes too long to fly here.
void check_unflown(const Parameters& world) {
  const radio::HeightGrid heights = radio::height_grid(world);
  wire::ChannelReport report;
  bus::put(report, agents::FlightInfo{.height_min_m = heights.height_min_m,
                                      .height_max_m = heights.height_max_m,
                                      .height_step_m = heights.height_step_m,
                                      .steps = static_cast<std::uint32_t>(world.integer("steps"))});
  check_sample(report);
  wire::HeightProfile profile;
  bus::put(profile,
           agents::HeightProfile{1, heights.height_min_m, heights.resolution_m, std::vector<double>(heights.size())});
  check_sample(profile);
}

void check_experiment(const experiment::Experiment& experiment, bool small) {
  wire::RunControl control;
  control.experiment_json(wire::bytes(experiment.canonical.dump()));
  check_sample(control);
  const experiment::Condition& condition = experiment.conditions.front();
  const wire::World world = world_sample(experiment, condition);
  check_sample(world);
  if (!small && condition.kind == experiment::WorldKind::generated) return check_unflown(condition.world);
  const auto map = map_of(experiment, condition, world);
  const flight::Costs costs = experiment.costs_in(condition);
  for (const agents::AgentSpec& spec : experiment.agents) {
    wire::EpisodeRecord record;
    record.agent(wire::name(spec.name));
    const std::string trace = store::encode_trace(fly_by_samples(*map, experiment.seed, spec, costs));
    record.trace(wire::bytes(trace));
    check_sample(record);
    const auto again = experiment::make_signal_map(experiment, condition, 0);
    const std::unique_ptr<agents::Agent> agent = spec.make();
    RC_ASSERT(trace == store::encode_trace(flight::fly(*again, experiment.seed, 0, *agent, spec, costs)));
  }
}

}  // namespace

TEST_CASE("every sample of an accepted experiment can be sent, and gives the same bytes") {
  const test::ScratchDir scratch;
  int accepted = 0;
  int refused = 0;
  const bool all_fly = rc::check([&] {
    const auto seed = *rc::gen::noShrink(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>()));
    const test::RandomExperiment random = test::random_experiment(seed, scratch.path(), false);
    std::optional<experiment::Experiment> experiment;
    try {
      experiment = experiment::parse(random.json.dump(), "random.json");
      ++accepted;
    } catch (const InputError&) {
      ++refused;
    }
    if (experiment) check_experiment(*experiment, random.small);
  });
  CHECK(all_fly);
  CHECK(accepted > 20);
  CHECK(refused > 10);
}

TEST_CASE("the largest worlds that an experiment can ask for fit on the wire") {
  nlohmann::json largest{{"steps", 10'000}, {"window_m", 10'000}, {"route_spacing_m", 1}, {"route_start_x_m", -5000}};
  largest.update({{"height_min_m", 30}, {"height_max_m", 30 + 0.1 * (limits::heights - 1)}});
  largest.update({{"height_step_m", 0.1}, {"height_resolution_m", 0.1}});
  largest.update({{"bs_density_per_km2", 500}, {"building_density_per_km2", 2000}, {"building_height_mean_m", 500}});
  const Parameters world = radio::resolve_generated_world(largest, "world");
  check_unflown(world);
  wire::World sample;
  bus::put(sample, world::generate_city(world, 1, 0));
  check_sample(sample);
  CHECK(sample.city().base_stations().size() > 49'000);

  // Their number is Poisson distributed: 20 standard deviations above the largest mean.
  double most = 0.0;
  for (const ParameterSpec& spec : world::city_parameters())
    if (spec.name == "bs_density_per_km2") most = spec.maximum;
  for (const ParameterSpec& spec : world::city_parameters())
    if (spec.name == "window_m") most *= spec.maximum * spec.maximum / 1e6;
  CHECK(most + 20.0 * std::sqrt(most) < limits::base_stations);
}

}  // namespace aloft
