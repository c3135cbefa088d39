// Fixed pieces of work whose instructions tools/instruction_count.sh counts with callgrind.

#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "common/flight/flight.hpp"
#include "common/learn/network.hpp"
#include "common/learn/test_networks.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;

namespace {

constexpr std::uint64_t seed = 1;

Parameters small_world() {
  return radio::resolve_generated_world(
      {{"bs_density_per_km2", 5}, {"building_density_per_km2", 200}, {"window_m", 2000}, {"steps", 21}}, "world");
}

std::unique_ptr<radio::SignalMap> prepared_map(std::uint32_t trial) {
  const Parameters world = small_world();
  auto map = radio::make_generated_map(world, world::generate_city(world, seed, trial), seed, trial);
  map->prepare();
  return map;
}

void fly(const char* agent, std::uint32_t trials) {
  const agents::AgentSpec spec = agents::parse_agents(agent, "command line").front();
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const auto map = prepared_map(trial);
    (void)flight::fly(*map, seed, trial, *spec.make(), spec);
  }
}

/// Flights that read one height per step, with their worlds.
void explore() {
  const agents::AgentSpec spec = agents::parse_agents("random-walk", "command line").front();
  const Parameters world = small_world();
  for (std::uint32_t trial = 0; trial < 10; ++trial) {
    const auto map = radio::make_generated_map(world, world::generate_city(world, seed, trial), seed, trial);
    (void)flight::fly(*map, seed, trial, *spec.make(), spec);
  }
}

void train() {
  const learn::NetworkShape shape = learn::dqn_shape(38);
  const auto network = learn::make_network(shape, {});
  RandomStream random(seed, 0, "work");
  network->load(learn::initial_state(shape, random));
  network->train(learn::random_minibatch(shape, 16, learn::Loss::mse, "work"), learn::Loss::mse, 10);
}

const std::map<std::string, std::function<void()>>& pieces() {
  static const std::map<std::string, std::function<void()>> all{
      {"gradient-steps", train},
      {"se-table", [] { prepared_map(0); }},
      {"random-walk-flights", explore},
      {"dqn-flight", [] { fly("dqn", 1); }},
      {"height-filter-flights", [] { fly("height-filter", 3); }},
      {"planner-flights", [] { fly("planner", 3); }},
  };
  return all;
}

}  // namespace

/// Callgrind counts this function: --toggle-collect names it.
extern "C" __attribute__((noinline)) void counted_work(const std::function<void()>& work) {
  work();
}

int main(int argc, char** argv) {
  const auto piece = pieces().find(argc == 2 ? argv[1] : "");
  if (piece == pieces().end()) {
    for (const auto& [name, work] : pieces()) fmt::print("{}\n", name);
    return argc == 1 ? EXIT_SUCCESS : 2;
  }
  counted_work(piece->second);
  return EXIT_SUCCESS;
}
