#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

#include "common/learn/network.hpp"

namespace bench {

constexpr std::size_t epochs = 200;  ///< gradient steps per step of a flight

/// Floating-point operations of one gradient step on a batch of 16.
struct Operations {
  double products = 0;  ///< forward, weight gradients, and deltas of all layers but the first, without biases
  double adam = 0;
};
[[nodiscard]] Operations operations(const aloft::learn::NetworkShape& shape);

/// The rate of a loop of nothing but multiply-adds, with the instructions of a path (portable: AVX2). It takes as many
/// turns as the training, so that both have the same chance of an undisturbed core.
class Floor {
 public:
  Floor(aloft::learn::Path path, std::size_t turns) : path_(path), best_s_(turns, 1e9) {}

  void take_turn(std::size_t turn);
  /// The time of this many operations.
  [[nodiscard]] double seconds(double operations) const;
  /// The time of a gradient step, as if a root or a quotient took no longer than a sum.
  [[nodiscard]] double step_s(const aloft::learn::NetworkShape& shape) const {
    const Operations all = operations(shape);
    return seconds(all.products + all.adam);
  }

 private:
  aloft::learn::Path path_;
  std::vector<double> best_s_;
};

struct TrainingTime {
  double step_s = 0;  ///< of a gradient step
  Floor floor;
};

/// All gradient steps on a random minibatch, with a network that was trained on another one before. Repeated; the
/// fastest turn of each counts.
[[nodiscard]] TrainingTime time_of_training(const aloft::learn::NetworkShape& shape, aloft::learn::Path path,
                                            aloft::learn::Loss loss, int trainings);

}  // namespace bench
