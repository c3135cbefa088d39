// Training speed beside the arithmetic floor of the same core: the time that the arithmetic of a gradient step would
// take at the rate of a pure multiply-add loop with the same instructions (Eigen: with AVX2). Two floors: all
// operations, as if a root or a quotient took no longer than a sum; and the matrix products alone, as if Adam took no
// time. Floor and training take short turns; see shortest_turn.hpp. Measured on random minibatches, in which nearly
// every unit is active for some sample, and in a DQN's flight, in which many units are inactive for a whole minibatch
// and are skipped.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "bench/learn_floor.hpp"
#include "bench/shortest_turn.hpp"
#include "common/agents/dqn.hpp"
#include "common/learn/network.hpp"
#include "common/learn/test_networks.hpp"

namespace {

using namespace aloft;
using learn::Loss;
using learn::Path;

constexpr int trainings = 100;
constexpr std::size_t steps_per_turn = 5;
constexpr std::uint32_t flight_steps = 100;
constexpr std::size_t epochs = 200;  // gradient steps per step of a flight

/// Floating-point operations of one gradient step on a batch of 16.
struct Operations {
  double products = 0;  ///< forward, weight gradients, and deltas of all layers but the first, without biases
  double adam = 0;
};

Operations operations(const learn::NetworkShape& shape) {
  constexpr double multiply_add = 2;
  constexpr double adam_per_weight = 2 + 3 + 3;  // first moment; second; root, quotient and difference
  Operations result;
  for (std::size_t i = 0; i < shape.layers.size(); ++i) {
    const auto inputs = static_cast<double>(shape.layers[i].inputs);
    const auto outputs = static_cast<double>(shape.layers[i].outputs);
    result.products += inputs * outputs * (i == 0 ? 2.0 : 3.0) * multiply_add * learn::batch_lanes;
    result.adam += (inputs + 1) * outputs * adam_per_weight;
  }
  return result;
}

/// Takes as many turns as the training, so that both have the same chance of an undisturbed core.
class Floor {
 public:
  Floor(Path path, std::size_t turns) : path_(path), best_s_(turns, 1e9) {}

  void take_turn(std::size_t turn) {
    bench::shortest_turn(best_s_[turn], path_ == Path::avx512 ? bench_floor::avx512_loop : bench_floor::avx2_loop);
  }
  /// The time of this many operations.
  [[nodiscard]] double seconds(double operations) const {
    const double per_instruction = path_ == Path::avx512 ? 32.0 : 16.0;
    const double turn_s = std::reduce(best_s_.begin(), best_s_.end()) / static_cast<double>(best_s_.size());
    return operations / (per_instruction * bench_floor::instructions_per_turn) * turn_s;
  }

 private:
  Path path_;
  std::vector<double> best_s_;
};

void print_row(Path path, const char* what, double step_s, const Floor& floor) {
  const Operations all = operations(learn::dqn_shape(38));
  const double floor_s = floor.seconds(all.products + all.adam);
  fmt::print("{:<10} {:<14} {:>18.1f} {:>10.1f} {:>10.2f} {:>21.2f}\n", learn::path_name(path), what, step_s * 1e6,
             floor_s * 1e6, step_s / floor_s, step_s / floor.seconds(all.products));
}

/// All gradient steps on a minibatch, as an agent takes them, with a network that was trained on another one before.
/// Repeated; the fastest turn counts.
void random_minibatches(Path path, Loss loss) {
  const learn::NetworkShape shape = learn::dqn_shape(38);
  const learn::Minibatch batch = learn::random_minibatch(shape, 16, loss, "benchmark");
  const auto network = learn::make_network(shape, {}, path);
  RandomStream random(1, 0, "benchmark");
  network->load(learn::initial_state(shape, random));
  network->train(learn::random_minibatch(shape, 16, loss, "before"), loss, epochs);
  const learn::NetworkState start = network->state();
  std::vector<double> best_s(epochs / steps_per_turn, 1e9);
  Floor floor(path, best_s.size());
  for (int training = 0; training < trainings; ++training) {
    network->load(start);
    for (std::size_t turn = 0; turn < best_s.size(); ++turn) {
      floor.take_turn(turn);
      bench::shortest_turn(best_s[turn], [&] { network->train(batch, loss, steps_per_turn); });
    }
  }
  const double step_s = std::reduce(best_s.begin(), best_s.end()) / static_cast<double>(epochs);
  print_row(path, loss == Loss::mse ? "mse" : "cross-entropy", step_s, floor);
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
  Floor floor(path, flight_steps);
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
  print_row(path, "DQN's flight", flight_s / (80.0 * epochs), floor);
  fmt::print("\nA flight of {} steps with the DQN: {:.2f} s of CPU time\n", flight_steps, flight_s);
}

}  // namespace

int main() {
  fmt::print("{:<10} {:<14} {:>18} {:>10} {:>10} {:>21}\n", "path", "loss", "us/gradient step", "floor", "x floor",
             "x its products alone");
  for (const Path path : learn::available_paths())
    for (const Loss loss : {Loss::mse, Loss::cross_entropy}) random_minibatches(path, loss);
  dqn_flight();
  return 0;
}
