// Training speed beside the arithmetic floor of the same core in the same run. Counters: "floor_ratio" is the time of a
// gradient step over the time that its multiplications alone would take at the rate of a pure multiply-add loop of the
// same instruction set (portable: of AVX2). Use a quiet machine, or --benchmark_repetitions and the smallest.

#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "bench/learn_floor.hpp"
#include "common/agents/dqn.hpp"
#include "common/learn/network.hpp"
#include "common/learn/test_networks.hpp"

namespace {

using aloft::learn::Loss;
using aloft::learn::Path;

/// Multiply-adds of one gradient step on a batch of 16: forward, weight gradients, and deltas of all layers but the
/// first, without biases.
double multiply_adds(const aloft::learn::NetworkShape& shape) {
  double per_sample = 0;
  for (std::size_t i = 0; i < shape.layers.size(); ++i) {
    const auto weights = static_cast<double>(shape.layers[i].inputs * shape.layers[i].outputs);
    per_sample += weights * (i == 0 ? 2.0 : 3.0);
  }
  return per_sample * aloft::learn::batch_lanes;
}

/// Multiply-adds per second of a pure loop, best of several short runs next to the benchmark that asks.
double floor_rate(Path path) {
  return path == Path::avx512 ? bench_floor::avx512_multiply_adds_per_s() : bench_floor::avx2_multiply_adds_per_s();
}

void gradient_step(benchmark::State& state, Path path, Loss loss) {
  const auto shape = aloft::learn::dqn_shape(38);
  const auto batch = aloft::learn::random_minibatch(shape, 16, loss, "benchmark");
  const auto network = aloft::learn::make_network(shape, {}, path);
  aloft::RandomStream random(1, 0, "benchmark");
  network->load(aloft::learn::initial_state(shape, random));
  constexpr std::size_t epochs = 200;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(network->train(batch, loss, epochs));
  const double floor_s = multiply_adds(shape) / floor_rate(path);
  const auto steps = static_cast<double>(state.iterations() * epochs);
  using benchmark::Counter;
  state.counters["floor_us"] = floor_s * 1e6;
  state.counters["step_us"] = Counter(steps * 1e-6, Counter::kIsRate | Counter::kInvert);
  state.counters["floor_ratio"] = Counter(steps * floor_s, Counter::kIsRate | Counter::kInvert);
}

/// Reports of a generated flight: the quality jumps between heights, as it does in the simulator.
aloft::agents::Observation report(std::uint32_t step, std::uint32_t steps, double& height_m,
                                  aloft::agents::Action action, aloft::RandomStream& random) {
  using aloft::agents::Action;
  if (action == Action::down) height_m = std::max(40.0, height_m - 10.0);
  if (action == Action::up) height_m = std::min(240.0, height_m + 10.0);
  aloft::agents::Observation observation;
  observation.step = step;
  observation.height_m = height_m;
  observation.serving_sinr_db = random.uniform(0.0, 60.0);
  observation.neighbour_count = 5;
  for (double& sinr_db : observation.neighbour_sinr_db) sinr_db = random.uniform(-20.0, 0.0);
  observation.executed = action;
  observation.qos = observation.reward = observation.serving_sinr_db / 3.0;
  observation.last = step == steps;
  return observation;
}

void dqn_episode(benchmark::State& state) {
  constexpr std::uint32_t steps = 100;
  const aloft::Parameters parameters(aloft::agents::dqn_parameters());
  std::uint32_t trial = 0;
  for ([[maybe_unused]] auto _ : state) {
    aloft::agents::Dqn agent(parameters);
    agent.begin({aloft::agents::QosKind::spectral_efficiency, 40, 240, 10, steps, 1, ++trial});
    aloft::RandomStream random(1, trial, "benchmark");
    double height_m = 40;
    auto action = aloft::agents::Action::none;
    for (std::uint32_t step = 0; step <= steps; ++step) {
      agent.observe(report(step, steps, height_m, action, random));
      if (step < steps) action = agent.act().action;
    }
  }
  // Steps 20 to 100 train: the history is complete after 4 steps, the first minibatch 16 steps later. On real replay
  // data many units are dead in the whole batch and left out, so the ratio is better than on random batches.
  const double gradient_steps = 81.0 * 200.0 * static_cast<double>(state.iterations());
  const Path path = aloft::learn::available_paths().back();
  const double floor_s = multiply_adds(aloft::learn::dqn_shape(38)) / floor_rate(path);
  using benchmark::Counter;
  state.counters["step_us"] = Counter(gradient_steps * 1e-6, Counter::kIsRate | Counter::kInvert);
  state.counters["floor_ratio"] = Counter(gradient_steps * floor_s, Counter::kIsRate | Counter::kInvert);
}

void register_benchmarks() {
  for (const Path path : aloft::learn::available_paths()) {
    for (const Loss loss : {Loss::mse, Loss::cross_entropy}) {
      const std::string name = "gradient_step/" + std::string(aloft::learn::path_name(path)) +
                               (loss == Loss::mse ? "/mse" : "/cross-entropy");
      benchmark::RegisterBenchmark(name.c_str(), gradient_step, path, loss)->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::RegisterBenchmark("dqn_episode_100_steps", dqn_episode)->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  register_benchmarks();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
