#include "common/learn/shape.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace aloft::learn {

std::size_t NetworkShape::parameters() const noexcept {
  std::size_t count = 0;
  for (const LayerShape& layer : layers) count += layer.parameters();
  return count;
}

void NetworkShape::check() const {
  if (layers.empty()) throw std::logic_error("a network needs at least one layer");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const LayerShape& layer = layers[i];
    const bool last = i + 1 == layers.size();
    if (layer.inputs == 0 || layer.outputs == 0) throw std::logic_error("a layer of a network has no width");
    if (layer.inputs > max_layer_width || layer.outputs > max_layer_width)
      throw std::logic_error(fmt::format("a layer of a network is wider than {}", max_layer_width));
    if (!last && layer.outputs != layers[i + 1].inputs)
      throw std::logic_error("the layers of a network do not fit together");
    if (layer.activation == (last ? Activation::relu : Activation::softplus))
      throw std::logic_error("hidden layers are linear or ReLU, the output layer linear or softplus");
  }
}

NetworkShape dqn_shape(std::size_t inputs, std::size_t hidden_width, std::size_t hidden_layers, std::size_t actions) {
  NetworkShape shape;
  shape.layers.push_back({inputs, inputs + 1, Activation::linear});
  for (std::size_t i = 0; i < hidden_layers; ++i)
    shape.layers.push_back({shape.outputs(), hidden_width, Activation::relu});
  shape.layers.push_back({shape.outputs(), actions, Activation::softplus});
  return shape;
}

double AdamSettings::step_size(std::size_t t) const noexcept {
  const auto n = static_cast<double>(t);
  const double corrected = learning_rate * std::sqrt(1.0 - std::pow(beta2, n)) / (1.0 - std::pow(beta1, n));
  return corrected * (1.0 - beta1) / std::sqrt(1.0 - beta2);
}

double AdamSettings::scaled_epsilon() const noexcept {
  return epsilon / std::sqrt(1.0 - beta2);
}

}  // namespace aloft::learn
