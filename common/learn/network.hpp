#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/random.hpp"
#include "common/learn/shape.hpp"

namespace aloft::learn {

/// The complete state of a network and its optimiser. Layout: per layer [output][inputs + 1], the bias last.
struct NetworkState {
  std::vector<float> weights;
  std::vector<float> first_moments;   ///< scaled, see AdamSettings
  std::vector<float> second_moments;  ///< scaled
  std::uint64_t steps = 0;            ///< gradient steps so far
};

/// Glorot-uniform weights (Glorot and Bengio 2010) in the order of the layout, zero biases and moments, as Keras.
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
  /// Throws std::logic_error if sizes do not fit the shape. Empty moments mean zeros.
  virtual void load(const NetworkState& state) = 0;

  /// `inputs` [sample][input] for any number of samples -> `outputs` [sample][output].
  virtual void predict(std::span<const float> inputs, std::span<float> outputs) = 0;
  /// `epochs` >= 1 steps of Adam on the same minibatch; returns the loss before the last step. Flushes denormals.
  virtual double train(const Minibatch& minibatch, Loss loss, std::size_t epochs) = 0;
};

/// How a network computes. avx512 and avx2 give the same bits; portable is the Eigen reference and differs in rounding.
enum class Path { portable, avx2, avx512 };

[[nodiscard]] std::string_view path_name(Path path) noexcept;
/// The paths that this CPU can run, slowest first; the portable one is always among them.
[[nodiscard]] std::vector<Path> available_paths();

/// A network with zero weights on the given path, by default the fastest one of this CPU. Throws std::logic_error if
/// the CPU cannot run the path.
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam);
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam, Path path);

/// Throws std::logic_error unless the minibatch fits the shape.
void check_minibatch(const NetworkShape& shape, const Minibatch& minibatch);

}  // namespace aloft::learn
