#include "common/learn/blocked_network.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include "common/learn/denormals.hpp"

namespace aloft::learn {
namespace {

constexpr std::size_t lanes = batch_lanes;
constexpr std::align_val_t alignment{64};

constexpr std::size_t rounded_up(std::size_t n) {
  return (n + lanes - 1) / lanes * lanes;
}

/// Outputs of a block with padding. A tile of the weight gradients walks through several blocks and their moments at
/// once. With an odd number of cache lines from block to block these lie in different sets of every cache; 128 lines
/// apart they would share one set, which has room for 8 or 12, and each store would delay the loads after it (4K
/// aliasing).
constexpr std::size_t padded_outputs(std::size_t outputs) {
  return outputs | 1U;
}

/// Where weight (output, input) lies in the block layout.
std::size_t block_index(const KernelLayer& layer, std::size_t output, std::size_t input) {
  return (input / lanes) * static_cast<std::size_t>(layer.block_stride) + output * lanes + input % lanes;
}

}  // namespace

AlignedFloats::AlignedFloats(std::size_t count)
    : data_(static_cast<float*>(::operator new[](count * sizeof(float), alignment))) {
  std::fill_n(data_.get(), count, 0.0F);
}

void AlignedFloats::Free::operator()(float* p) const noexcept {
  ::operator delete[](p, alignment);
}

BlockedNetwork::BlockedNetwork(NetworkShape shape, const AdamSettings& adam, const Kernels& kernels)
    : shape_(std::move(shape)), adam_(adam), kernels_(kernels) {
  shape_.check();
  build_layers();
}

float* BlockedNetwork::allocate(std::size_t count) {
  return memory_.emplace_back(count).data();
}

void BlockedNetwork::build_layers() {
  std::size_t widest = 0;
  for (const LayerShape& shape : shape_.layers) {
    const std::size_t rows = rounded_up(shape.inputs + 1);
    const std::size_t stride = padded_outputs(shape.outputs) * lanes;
    const std::size_t parameters = rows / lanes * stride;
    widest = std::max({widest, rows, rounded_up(shape.outputs)});
    alive_.emplace_back(rows / lanes, 0U);
    KernelLayer& layer = layers_.emplace_back();
    layer.inputs = static_cast<int>(shape.inputs);
    layer.outputs = static_cast<int>(shape.outputs);
    layer.blocks = static_cast<int>(rows / lanes);
    layer.activation = shape.activation;
    layer.block_stride = static_cast<long>(stride);
    // One allocation for all three: separate large allocations start at the same offset in a page, and each store to
    // one array would delay the load from the next (4K aliasing).
    layer.weights = allocate(3 * parameters);
    layer.first_moments = layer.weights + parameters;
    layer.second_moments = layer.first_moments + parameters;
    layer.input = allocate(rows * lanes);
    std::fill_n(layer.input + shape.inputs * lanes, lanes, 1.0F);  // the constant input of the bias
    layer.input_by_sample = allocate(rows * lanes);
    layer.alive = alive_.back().data();
    for (std::size_t i = 0; i <= shape.inputs; ++i) layer.alive[i / lanes] |= 1U << (i % lanes);
  }
  order_.resize(widest);
  samples_.resize(widest * lanes);
  gradient_groups_.resize(gradient_groups * widest);
  network_.layer_count = static_cast<int>(layers_.size());
  network_.layers = layers_.data();
  for (float** array : {&network_.output, &network_.slope, &network_.targets, &network_.counted, &network_.delta,
                        &network_.delta_below})
    *array = allocate((widest + lanes) * lanes);
  network_.order = order_.data();
  network_.samples = samples_.data();
  network_.gradient_groups = gradient_groups_.data();
}

std::vector<float> BlockedNetwork::flat(Array member) const {
  std::vector<float> values;
  values.reserve(shape_.parameters());
  for (const KernelLayer& layer : layers_) {
    for (std::size_t o = 0; o < static_cast<std::size_t>(layer.outputs); ++o)
      for (std::size_t i = 0; i <= static_cast<std::size_t>(layer.inputs); ++i)
        values.push_back((layer.*member)[block_index(layer, o, i)]);
  }
  return values;
}

void BlockedNetwork::fill(Array member, std::span<const float> values) {
  if (!values.empty() && values.size() != shape_.parameters())
    throw std::logic_error("a network's state does not fit its shape");
  std::size_t next = 0;
  for (const KernelLayer& layer : layers_) {
    for (std::size_t o = 0; o < static_cast<std::size_t>(layer.outputs); ++o)
      for (std::size_t i = 0; i <= static_cast<std::size_t>(layer.inputs); ++i)
        (layer.*member)[block_index(layer, o, i)] = values.empty() ? 0.0F : values[next++];
  }
}

NetworkState BlockedNetwork::state() const {
  return {flat(&KernelLayer::weights), flat(&KernelLayer::first_moments), flat(&KernelLayer::second_moments), steps_};
}

void BlockedNetwork::load(const NetworkState& state) {
  if (state.weights.empty()) throw std::logic_error("a network's state has no weights");
  fill(&KernelLayer::weights, state.weights);
  fill(&KernelLayer::first_moments, state.first_moments);
  fill(&KernelLayer::second_moments, state.second_moments);
  steps_ = state.steps;
}

void BlockedNetwork::load_inputs(std::span<const float> inputs, std::size_t samples) {
  const KernelLayer& first = layers_.front();
  const std::size_t width = shape_.inputs();
  const std::size_t stride = rounded_up(width + 1);
  std::fill_n(first.input, width * lanes, 0.0F);
  for (std::size_t s = 0; s < samples; ++s)
    for (std::size_t i = 0; i < width; ++i) first.input[i * lanes + s] = inputs[s * width + i];
  for (std::size_t s = 0; s < lanes; ++s)
    for (std::size_t i = 0; i < stride; ++i) first.input_by_sample[s * stride + i] = first.input[i * lanes + s];
}

void BlockedNetwork::load_targets(const Minibatch& minibatch) {
  const std::size_t outputs = shape_.outputs();
  std::fill_n(network_.targets, outputs * lanes, 0.0F);
  std::fill_n(network_.counted, outputs * lanes, 0.0F);
  for (std::size_t s = 0; s < minibatch.size; ++s) {
    for (std::size_t o = 0; o < outputs; ++o) {
      network_.targets[o * lanes + s] = minibatch.targets[s * outputs + o];
      network_.counted[o * lanes + s] = minibatch.counted[s * outputs + o];
    }
  }
}

void BlockedNetwork::predict(std::span<const float> inputs, std::span<float> outputs) {
  const std::size_t samples = inputs.size() / shape_.inputs();
  if (inputs.size() != samples * shape_.inputs() || outputs.size() != samples * shape_.outputs())
    throw std::logic_error("predict: sizes do not fit the network");
  const FlushDenormals guard;
  for (std::size_t first = 0; first < samples; first += lanes) {
    const std::size_t n = std::min(lanes, samples - first);
    load_inputs(inputs.subspan(first * shape_.inputs(), n * shape_.inputs()), n);
    kernels_.forward(network_);
    for (std::size_t s = 0; s < n; ++s)
      for (std::size_t o = 0; o < shape_.outputs(); ++o)
        outputs[(first + s) * shape_.outputs() + o] = network_.output[o * lanes + s];
  }
}

double BlockedNetwork::loss_of(const Minibatch& minibatch, Loss loss) const {
  double sum = 0.0;
  for (std::size_t s = 0; s < minibatch.size; ++s) {
    double all = 0.0;
    double labelled = 0.0;
    for (std::size_t o = 0; o < shape_.outputs(); ++o) {
      const auto q = static_cast<double>(network_.output[o * lanes + s]);
      const auto target = static_cast<double>(network_.targets[o * lanes + s]);
      const double error = (q - target) * static_cast<double>(network_.counted[o * lanes + s]);
      all += q;
      labelled += q * target;
      if (loss == Loss::mse) sum += error * error;
    }
    if (loss == Loss::cross_entropy) sum -= std::log(std::clamp(labelled / all, 1e-7, 1.0 - 1e-7));
  }
  return sum / static_cast<double>(minibatch.size);
}

double BlockedNetwork::train(const Minibatch& minibatch, Loss loss, std::size_t epochs) {
  check_minibatch(shape_, minibatch);
  if (epochs == 0) throw std::logic_error("train: at least one epoch");
  load_inputs(minibatch.inputs, minibatch.size);
  load_targets(minibatch);
  std::vector<float> step_sizes(epochs);
  for (float& step_size : step_sizes) step_size = static_cast<float>(adam_.step_size(++steps_));
  const KernelTraining training{.loss = loss,
                                .per_sample = 1.0F / static_cast<float>(minibatch.size),
                                .epochs = static_cast<int>(epochs),
                                .step_sizes = step_sizes.data(),
                                .beta1 = static_cast<float>(adam_.beta1),
                                .beta2 = static_cast<float>(adam_.beta2),
                                .epsilon = static_cast<float>(adam_.scaled_epsilon())};
  const FlushDenormals guard;
  kernels_.train(network_, training);
  return loss_of(minibatch, loss);
}

}  // namespace aloft::learn
