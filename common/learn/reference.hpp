#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/learn/network.hpp"

namespace aloft::learn {

/// A direct implementation of the network with Eigen: in float the portable path, in double what all paths are tested
/// against. Activations are [unit][sample] with a last row of ones that the bias multiplies.
template <typename Scalar>
class ReferenceNetwork {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  ReferenceNetwork(NetworkShape shape, AdamSettings adam);

  [[nodiscard]] const NetworkShape& shape() const noexcept { return shape_; }
  [[nodiscard]] std::vector<Scalar> weights() const { return flat(&Layer::weights); }
  [[nodiscard]] std::vector<Scalar> first_moments() const { return flat(&Layer::first_moments); }
  [[nodiscard]] std::vector<Scalar> second_moments() const { return flat(&Layer::second_moments); }
  [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }
  /// Flat arrays in the layout of NetworkState; empty moments mean zeros.
  void load(std::span<const Scalar> weights, std::span<const Scalar> first_moments,
            std::span<const Scalar> second_moments, std::uint64_t steps);

  /// `inputs` [input][sample] -> [output][sample].
  [[nodiscard]] Matrix predict(const Matrix& inputs);
  [[nodiscard]] Scalar loss(const Minibatch& minibatch, Loss loss);
  /// d loss / d weights, in the layout of NetworkState. Returns the loss.
  Scalar gradient(const Minibatch& minibatch, Loss loss, std::vector<Scalar>& gradient);
  /// One gradient step of Adam; returns the loss before it.
  Scalar step(const Minibatch& minibatch, Loss loss);

 private:
  struct Layer {
    Matrix weights, first_moments, second_moments, gradient;
  };

  [[nodiscard]] std::vector<Scalar> flat(Matrix Layer::*member) const;
  void fill(Matrix Layer::*member, std::span<const Scalar> values);
  void forward(const Matrix& inputs);
  /// Returns the loss, and leaves its derivative with respect to the output layer's sums in delta_.
  Scalar output_delta(const Minibatch& minibatch, Loss loss);
  void backward();

  NetworkShape shape_;
  AdamSettings adam_;
  std::uint64_t steps_ = 0;
  std::vector<Layer> layers_;
  std::vector<Matrix> activations_;  // [layer]: its inputs, with the row of ones
  Matrix sums_;                      // of the output layer, before its activation
  Matrix outputs_;
  Matrix delta_;
};

extern template class ReferenceNetwork<float>;
extern template class ReferenceNetwork<double>;

/// The portable path.
class PortableNetwork final : public Network {
 public:
  PortableNetwork(const NetworkShape& shape, const AdamSettings& adam) : reference_(shape, adam) {}

  [[nodiscard]] const NetworkShape& shape() const noexcept override { return reference_.shape(); }
  [[nodiscard]] NetworkState state() const override;
  void load(const NetworkState& state) override;
  void predict(std::span<const float> inputs, std::span<float> outputs) override;
  double train(const Minibatch& minibatch, Loss loss, std::size_t epochs) override;

 private:
  ReferenceNetwork<float> reference_;
};

}  // namespace aloft::learn
