#pragma once

#include <cstddef>
#include <vector>

#include "common/learn/kernels.hpp"

namespace aloft::learn {

/// One dense layer: outputs = activation(W inputs + b).
struct LayerShape {
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  Activation activation = Activation::linear;

  /// Weights and biases; stored [output][inputs + 1], the bias last.
  [[nodiscard]] std::size_t parameters() const noexcept { return outputs * (inputs + 1); }
  friend bool operator==(const LayerShape&, const LayerShape&) = default;
};

/// The kernels count the rows of a layer in `int`.
inline constexpr std::size_t max_layer_width = 4'096;

/// A feed-forward network. Hidden layers are linear or ReLU, the output layer linear or softplus.
struct NetworkShape {
  std::vector<LayerShape> layers;

  [[nodiscard]] std::size_t inputs() const noexcept { return layers.front().inputs; }
  [[nodiscard]] std::size_t outputs() const noexcept { return layers.back().outputs; }
  [[nodiscard]] std::size_t parameters() const noexcept;
  friend bool operator==(const NetworkShape&, const NetworkShape&) = default;
  /// std::logic_error if the layers do not fit together, are wider than max_layer_width or use an activation in the
  /// wrong place.
  void check() const;
};

/// The network of the paper's DQN: a linear layer as wide as the input + 1, `hidden_layers` x `hidden_width` ReLU,
/// `actions` softplus outputs.
[[nodiscard]] NetworkShape dqn_shape(std::size_t inputs, std::size_t hidden_width = 200, std::size_t hidden_layers = 3,
                                     std::size_t actions = 3);

/// Adam as Keras has it (Kingma and Ba 2015, section 2, with "epsilon hat"):
/// w -= lr sqrt(1-b2^t)/(1-b1^t) m / (sqrt(v) + eps).
struct AdamSettings {
  double learning_rate = 1e-3;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-7;

  /// Every implementation keeps moments scaled, M = m/(1-b1) and V = v/(1-b2), so that a step is
  /// M <- b1 M + g, V <- b2 V + g^2, w <- w - step_size(t) M / (sqrt(V) + scaled_epsilon()). t counts from 1.
  [[nodiscard]] double step_size(std::size_t t) const noexcept;
  [[nodiscard]] double scaled_epsilon() const noexcept;
};

}  // namespace aloft::learn
