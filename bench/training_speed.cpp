#include "bench/training_speed.hpp"

#include "bench/learn_floor.hpp"
#include "bench/shortest_turn.hpp"
#include "common/learn/test_networks.hpp"

namespace bench {
namespace {

using namespace aloft;
using learn::Path;

constexpr std::size_t steps_per_turn = 5;

}  // namespace

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

void Floor::take_turn(std::size_t turn) {
  shortest_turn(best_s_[turn], path_ == Path::avx512 ? bench_floor::avx512_loop : bench_floor::avx2_loop);
}

double Floor::seconds(double operations) const {
  const double per_instruction = path_ == Path::avx512 ? 32.0 : 16.0;
  const double turn_s = std::reduce(best_s_.begin(), best_s_.end()) / static_cast<double>(best_s_.size());
  return operations / (per_instruction * bench_floor::instructions_per_turn) * turn_s;
}

TrainingTime time_of_training(const learn::NetworkShape& shape, Path path, learn::Loss loss, int trainings) {
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
      shortest_turn(best_s[turn], [&] { network->train(batch, loss, steps_per_turn); });
    }
  }
  return {std::reduce(best_s.begin(), best_s.end()) / static_cast<double>(epochs), floor};
}

}  // namespace bench
