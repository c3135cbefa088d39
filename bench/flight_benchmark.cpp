// In-process flights of agents: steps per second, without table generation. The claim: at least 500,000 steps/s on one
// core. "floor" is the least work of any implementation for the same record: read one cell of the table per step and
// store it; "x_floor" is how many times longer an agent's step takes.
#include <benchmark/benchmark.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "common/base/random.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/synthetic_map.hpp"

namespace {

using namespace aloft;

/// As large as the table of a generated world: 101 points, 201 heights of 1 m.
flight::SyntheticMap city_sized_map() {
  RandomStream random(1, 0, "benchmark");
  const radio::HeightGrid grid{40, 240, 10, 1};
  std::vector<std::vector<double>> qos(101, std::vector<double>(grid.size()));
  for (auto& column : qos)
    for (double& value : column) value = random.uniform(0.5, 20.0);
  return {radio::QosKind::spectral_efficiency, grid, std::move(qos)};
}

flight::FlightRecord walk_the_table(flight::SyntheticMap& map) {
  flight::FlightRecord record;
  record.steps.reserve(map.steps());
  for (std::uint32_t step = 1; step <= map.steps(); ++step) {
    const radio::Reading& reading = map.column(map.result_point(step), {})[0];
    record.steps.push_back({step,
                            agents::Action::hold,
                            10.0 * step,
                            0.0,
                            40.0,
                            reading.serving_cell,
                            reading.serving_sinr_db,
                            reading.qos,
                            reading.qos,
                            0,
                            {}});
  }
  return record;
}

double floor_seconds_per_step() {
  static const double seconds = [] {
    auto map = city_sized_map();
    constexpr int flights = 20'000;
    const std::clock_t start = std::clock();  // CPU time, as in the counters below
    for (int i = 0; i < flights; ++i) benchmark::DoNotOptimize(walk_the_table(map));
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / flights / map.steps();
  }();
  return seconds;
}

void count_steps(benchmark::State& state, std::uint32_t steps_per_flight) {
  const double steps = static_cast<double>(steps_per_flight);
  state.counters["steps_per_s"] = benchmark::Counter(steps, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["x_floor"] = benchmark::Counter(
      steps * floor_seconds_per_step(), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void floor_of_table_walk(benchmark::State& state) {
  auto map = city_sized_map();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(walk_the_table(map));
  count_steps(state, map.steps());
}

void fly_agent(benchmark::State& state, const char* name) {
  auto map = city_sized_map();
  const agents::AgentSpec spec = agents::parse_agents(name, "benchmark").front();
  std::uint32_t trial = 0;
  for ([[maybe_unused]] auto _ : state) {
    const auto agent = spec.make();
    benchmark::DoNotOptimize(flight::fly(map, 1, trial++, *agent, spec));
  }
  count_steps(state, map.steps());
}

BENCHMARK(floor_of_table_walk);
BENCHMARK_CAPTURE(fly_agent, min_height, "min-height");
BENCHMARK_CAPTURE(fly_agent, constant_120, "constant-120");
BENCHMARK_CAPTURE(fly_agent, random_walk, "random-walk");
BENCHMARK_CAPTURE(fly_agent, one_step_ahead, "one-step-ahead");
BENCHMARK_CAPTURE(fly_agent, optimal_height, "optimal-height");
BENCHMARK_CAPTURE(fly_agent, planner, "planner");
BENCHMARK_CAPTURE(fly_agent, local_bandit, "local-bandit");
BENCHMARK_CAPTURE(fly_agent, height_filter, "height-filter");

}  // namespace
