// Training speed beside the arithmetic floor of the same core: the time that the arithmetic of a gradient step would
// take at the rate of a pure multiply-add loop with the same instructions (Eigen: with AVX2). Two floors: all
// operations, as if a root or a quotient took no longer than a sum; and the matrix products alone, as if Adam took no
// time. Floor and training take short turns; see shortest_turn.hpp. Measured on random minibatches, in which nearly
// every unit is active for some sample, and in a DQN's flight, in which many units are inactive for a whole minibatch
// and are skipped.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/shortest_turn.hpp"
#include "bench/training_speed.hpp"
#include "bench/widths_table.hpp"
#include "common/agents/dqn.hpp"
#include "common/learn/network.hpp"

namespace {

using namespace aloft;
using learn::Loss;
using learn::Path;

constexpr int trainings = 100;
constexpr std::uint32_t flight_steps = 100;

void print_row(Path path, const char* what, double step_s, const bench::Floor& floor) {
  const bench::Operations all = bench::operations(learn::dqn_shape(38));
  const double floor_s = floor.seconds(all.products + all.adam);
  fmt::print("{:<10} {:<14} {:>18.1f} {:>10.1f} {:>10.2f} {:>21.2f}\n", learn::path_name(path), what, step_s * 1e6,
             floor_s * 1e6, step_s / floor_s, step_s / floor.seconds(all.products));
}

/// All gradient steps on a minibatch, as an agent takes them.
void random_minibatches(Path path, Loss loss) {
  const bench::TrainingTime time = bench::time_of_training(learn::dqn_shape(38), path, loss, trainings);
  print_row(path, loss == Loss::mse ? "mse" : "cross-entropy", time.step_s, time.floor);
}

/// Reports of a flight in which the quality jumps between heights, as it does in the simulator.
agents::Observation report(std::uint32_t step, double& height_m, agents::Action action, RandomStream& random) {
  using agents::Action;
  if (action == Action::down) height_m = std::max(40.0, height_m - 10.0);
  if (action == Action::up) height_m = std::min(240.0, height_m + 10.0);
  agents::Observation observation;
  observation.step = step;
  observation.height_m = height_m;
  observation.serving_sinr_db = random.uniform(0.0, 60.0);
  observation.neighbour_count = 5;
  for (double& sinr_db : observation.neighbour_sinr_db) sinr_db = random.uniform(-20.0, 0.0);
  observation.executed = action;
  observation.qos = observation.reward = observation.serving_sinr_db / 3.0;
  observation.last = step == flight_steps;
  return observation;
}

/// The same flight several times; the fastest turn of each of its steps counts.
void dqn_flight() {
  constexpr int flights = 5;
  const Parameters parameters(agents::dqn_parameters());
  std::vector<double> best_s(flight_steps, 1e9);
  const Path path = learn::available_paths().back();
  bench::Floor floor(path, flight_steps);
  for (int flight = 0; flight < flights; ++flight) {
    agents::Dqn agent(parameters);
    agent.begin({radio::QosKind::spectral_efficiency, 40, 240, 10, flight_steps, 1, 1});
    RandomStream random(1, 1, "benchmark");
    double height_m = 40;
    auto action = agents::Action::none;
    for (std::uint32_t step = 0; step < flight_steps; ++step) {
      floor.take_turn(step);
      bench::shortest_turn(best_s[step], [&] {
        agent.observe(report(step, height_m, action, random));
        action = agent.act().action;
      });
    }
  }
  double flight_s = 0.0;
  for (const double step_s : best_s) flight_s += step_s;
  // Steps 20 to 99 train: the history is complete after 4 steps, the first minibatch 16 steps later.
  print_row(path, "DQN's flight", flight_s / (80.0 * bench::epochs), floor);
  fmt::print("\nA flight of {} steps with the DQN: {:.2f} s of CPU time\n", flight_steps, flight_s);
}

void print_paper() {
  fmt::print("{:<10} {:<14} {:>18} {:>10} {:>10} {:>21}\n", "path", "loss", "us/gradient step", "floor", "x floor",
             "x its products alone");
  for (const Path path : learn::available_paths())
    for (const Loss loss : {Loss::mse, Loss::cross_entropy}) random_minibatches(path, loss);
  dqn_flight();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Training speed beside the arithmetic floor of the same core");
  std::string widths;
  app.add_option(
         "--widths", widths,
         "Networks of these widths instead of the paper's alone, e.g. 64..512, beside the caches that they fill")
      ->check(CLI::Validator(&bench::fault_of_widths, "FIRST..LAST"));
  CLI11_PARSE(app, argc, argv);
  if (!widths.empty()) {
    bench::print_widths(widths);
    return 0;
  }
  print_paper();
  return 0;
}
