#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/random.hpp"
#include "common/learn/shape.hpp"

namespace aloft::learn {

/// Everything a network's future depends on. Layout: per layer [output][inputs + 1], the bias last.
struct NetworkState {
  std::vector<float> weights;
  std::vector<float> first_moments;   ///< scaled, see AdamSettings
  std::vector<float> second_moments;  ///< scaled
  std::uint64_t steps = 0;            ///< gradient steps so far
};

/// Glorot-uniform weights in the order of the layout, zero biases and moments (Keras' defaults).
[[nodiscard]] NetworkState initial_state(const NetworkShape& shape, RandomStream& random);

/// Samples to fit, at most batch_lanes of them.
struct Minibatch {
  std::size_t size = 0;
  std::vector<float> inputs;   ///< [sample][input]
  std::vector<float> targets;  ///< [sample][output]; cross-entropy: one-hot
  std::vector<float> counted;  ///< [sample][output]: 1 where mse counts the error, else 0; cross-entropy: not read
};

/// A dense network that predicts and learns in single precision. One object is used by one thread at a time.
class Network {
 public:
  virtual ~Network() = default;

  [[nodiscard]] virtual const NetworkShape& shape() const noexcept = 0;
  [[nodiscard]] virtual NetworkState state() const = 0;
  /// Sizes must fit the shape (std::logic_error); empty moments mean zeros.
  virtual void load(const NetworkState& state) = 0;

  /// `inputs` [sample][input] for any number of samples -> `outputs` [sample][output].
  virtual void predict(std::span<const float> inputs, std::span<float> outputs) = 0;
  /// `epochs` >= 1 steps of Adam on the same minibatch; returns the loss before the last of them. Denormals are
  /// flushed.
  virtual double train(const Minibatch& minibatch, Loss loss, std::size_t epochs) = 0;
};

/// How a network computes. avx512 and avx2 give the same bits; portable is the Eigen reference and differs in rounding.
enum class Path { portable, avx2, avx512 };

[[nodiscard]] std::string_view path_name(Path path) noexcept;
/// What this CPU can run, slowest first; the portable path is always there.
[[nodiscard]] std::vector<Path> available_paths();

/// A network with zero weights on the given path, or the fastest of this CPU. std::logic_error if the path is not
/// available.
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam);
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam, Path path);

/// Throws std::logic_error unless the minibatch fits the shape.
void check_minibatch(const NetworkShape& shape, const Minibatch& minibatch);

}  // namespace aloft::learn
