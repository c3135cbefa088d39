#include "common/learn/reference.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/learn/denormals.hpp"

namespace aloft::learn {
namespace {

template <typename Matrix>
Matrix transposed_copy(std::span<const float> rows, std::size_t samples) {
  const auto n = static_cast<Eigen::Index>(samples);
  const auto width = n == 0 ? 0 : static_cast<Eigen::Index>(rows.size()) / n;
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Rows>(rows.data(), n, width).transpose().template cast<typename Matrix::Scalar>();
}

template <typename Scalar>
Scalar softplus(Scalar x) {
  return std::max(x, Scalar(0)) + std::log1p(std::exp(-std::fabs(x)));
}

template <typename Scalar>
Scalar sigmoid(Scalar x) {
  return Scalar(1) / (Scalar(1) + std::exp(-x));
}

}  // namespace

template <typename Scalar>
ReferenceNetwork<Scalar>::ReferenceNetwork(NetworkShape shape, AdamSettings adam)
    : shape_(std::move(shape)), adam_(adam) {
  shape_.check();
  for (const LayerShape& layer : shape_.layers) {
    const Matrix zero =
        Matrix::Zero(static_cast<Eigen::Index>(layer.outputs), static_cast<Eigen::Index>(layer.inputs + 1));
    layers_.push_back({zero, zero, zero, zero});
  }
  activations_.resize(layers_.size());
}

template <typename Scalar>
std::vector<Scalar> ReferenceNetwork<Scalar>::flat(Matrix Layer::*member) const {
  std::vector<Scalar> values;
  values.reserve(shape_.parameters());
  for (const Layer& layer : layers_) {
    const Matrix& matrix = layer.*member;
    values.insert(values.end(), matrix.data(), matrix.data() + matrix.size());
  }
  return values;
}

template <typename Scalar>
void ReferenceNetwork<Scalar>::fill(Matrix Layer::*member, std::span<const Scalar> values) {
  if (!values.empty() && values.size() != shape_.parameters())
    throw std::logic_error("a network's state does not fit its shape");
  const Scalar* next = values.data();
  for (Layer& layer : layers_) {
    Matrix& matrix = layer.*member;
    if (values.empty()) {
      matrix.setZero();
    } else {
      matrix = Eigen::Map<const Matrix>(next, matrix.rows(), matrix.cols());
      next += matrix.size();
    }
  }
}

template <typename Scalar>
void ReferenceNetwork<Scalar>::load(std::span<const Scalar> weights, std::span<const Scalar> first_moments,
                                    std::span<const Scalar> second_moments, std::uint64_t steps) {
  if (weights.empty()) throw std::logic_error("a network's state has no weights");
  fill(&Layer::weights, weights);
  fill(&Layer::first_moments, first_moments);
  fill(&Layer::second_moments, second_moments);
  steps_ = steps;
}

template <typename Scalar>
void ReferenceNetwork<Scalar>::forward(const Matrix& inputs) {
  const auto with_ones = [](Matrix& to, const auto& from) {
    to.resize(from.rows() + 1, from.cols());
    to.topRows(from.rows()) = from;
    to.bottomRows(1).setOnes();
  };
  with_ones(activations_[0], inputs);
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    sums_.noalias() = layers_[i].weights * activations_[i];
    switch (shape_.layers[i].activation) {
      case Activation::relu:
        with_ones(activations_[i + 1], sums_.cwiseMax(Scalar(0)));
        break;
      case Activation::linear:
        if (i + 1 < layers_.size()) {
          with_ones(activations_[i + 1], sums_);
        } else {
          outputs_ = sums_;
        }
        break;
      case Activation::softplus:
        outputs_ = sums_.unaryExpr([](Scalar x) { return softplus(x); });
        break;
    }
  }
}

template <typename Scalar>
auto ReferenceNetwork<Scalar>::predict(const Matrix& inputs) -> Matrix {
  forward(inputs);
  return outputs_;
}

template <typename Scalar>
Scalar ReferenceNetwork<Scalar>::output_delta(const Minibatch& minibatch, Loss loss) {
  const auto targets = transposed_copy<Matrix>(minibatch.targets, minibatch.size);
  const auto per_sample = Scalar(1) / static_cast<Scalar>(minibatch.size);
  Scalar value = 0;
  if (loss == Loss::mse) {
    const auto counted = transposed_copy<Matrix>(minibatch.counted, minibatch.size);
    delta_ = (outputs_ - targets).cwiseProduct(counted);
    value = delta_.squaredNorm() * per_sample;
    delta_ *= 2 * per_sample;
  } else {
    const auto clip = static_cast<Scalar>(1e-7);
    delta_.setZero(outputs_.rows(), outputs_.cols());
    for (Eigen::Index s = 0; s < outputs_.cols(); ++s) {
      const Scalar sum = outputs_.col(s).sum();
      const Scalar labelled = outputs_.col(s).dot(targets.col(s));
      const Scalar p = labelled / sum;
      const bool inside = p >= clip && p <= 1 - clip;
      value -= std::log(inside ? p : (p > clip ? 1 - clip : clip)) * per_sample;
      // Where Keras clips the probability, its gradient is zero.
      if (inside) delta_.col(s).array() = (Scalar(1) / sum - targets.col(s).array() / labelled) * per_sample;
    }
  }
  if (shape_.layers.back().activation == Activation::softplus)
    delta_.array() *= sums_.unaryExpr([](Scalar x) { return sigmoid(x); }).array();
  return value;
}

template <typename Scalar>
void ReferenceNetwork<Scalar>::backward() {
  for (std::size_t i = layers_.size(); i-- > 0;) {
    layers_[i].gradient.noalias() = delta_ * activations_[i].transpose();
    if (i == 0) break;
    Matrix before = layers_[i].weights.leftCols(layers_[i].weights.cols() - 1).transpose() * delta_;
    if (shape_.layers[i - 1].activation == Activation::relu)
      before = (activations_[i].topRows(before.rows()).array() > Scalar(0)).select(before, Scalar(0));
    delta_ = std::move(before);
  }
}

template <typename Scalar>
Scalar ReferenceNetwork<Scalar>::loss(const Minibatch& minibatch, Loss loss) {
  check_minibatch(shape_, minibatch);
  forward(transposed_copy<Matrix>(minibatch.inputs, minibatch.size));
  return output_delta(minibatch, loss);
}

template <typename Scalar>
Scalar ReferenceNetwork<Scalar>::gradient(const Minibatch& minibatch, Loss loss, std::vector<Scalar>& gradient) {
  const Scalar value = this->loss(minibatch, loss);
  backward();
  gradient = flat(&Layer::gradient);
  return value;
}

template <typename Scalar>
Scalar ReferenceNetwork<Scalar>::step(const Minibatch& minibatch, Loss loss) {
  const Scalar value = this->loss(minibatch, loss);
  backward();
  ++steps_;
  const auto beta1 = static_cast<Scalar>(adam_.beta1);
  const auto beta2 = static_cast<Scalar>(adam_.beta2);
  const auto step_size = static_cast<Scalar>(adam_.step_size(steps_));
  const auto epsilon = static_cast<Scalar>(adam_.scaled_epsilon());
  for (Layer& layer : layers_) {
    const auto g = layer.gradient.array();
    layer.first_moments.array() = beta1 * layer.first_moments.array() + g;
    layer.second_moments.array() = beta2 * layer.second_moments.array() + g * g;
    layer.weights.array() -= step_size * layer.first_moments.array() / (layer.second_moments.array().sqrt() + epsilon);
  }
  return value;
}

template class ReferenceNetwork<float>;
template class ReferenceNetwork<double>;

NetworkState PortableNetwork::state() const {
  return {reference_.weights(), reference_.first_moments(), reference_.second_moments(), reference_.steps()};
}

void PortableNetwork::load(const NetworkState& state) {
  reference_.load(state.weights, state.first_moments, state.second_moments, state.steps);
}

void PortableNetwork::predict(std::span<const float> inputs, std::span<float> outputs) {
  const std::size_t samples = inputs.size() / shape().inputs();
  if (inputs.size() != samples * shape().inputs() || outputs.size() != samples * shape().outputs())
    throw std::logic_error("predict: sizes do not fit the network");
  const FlushDenormals guard;
  using Matrix = ReferenceNetwork<float>::Matrix;
  const Matrix result = reference_.predict(transposed_copy<Matrix>(inputs, samples));
  Eigen::Map<Matrix>(outputs.data(), result.cols(), result.rows()) = result.transpose();
}

double PortableNetwork::train(const Minibatch& minibatch, Loss loss, std::size_t epochs) {
  if (epochs == 0) throw std::logic_error("train: at least one epoch");
  const FlushDenormals guard;
  float value = 0;
  for (std::size_t epoch = 0; epoch < epochs; ++epoch) value = reference_.step(minibatch, loss);
  return static_cast<double>(value);
}

}  // namespace aloft::learn
