// A gradient step of the paper's network (38-39-200-200-200-3, batch 16, Adam) with our kernels, with Eigen and with
// libtorch as a user would write it and as an expert would tune it: one thread, the same minibatches and initial
// weights, in turns within one run. Each time is the shortest of many turns, so that other programs hardly count.

#include <fmt/format.h>
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/shortest_turn.hpp"
#include "common/learn/network.hpp"
#include "common/learn/test_networks.hpp"

namespace {

namespace learn = aloft::learn;

constexpr std::int64_t batch = 16;
constexpr std::size_t steps_per_turn = 10;
constexpr int turns = 150;
constexpr std::size_t minibatches = 4;

const learn::AdamSettings adam;

/// An implementation to compare: takes `steps` gradient steps on the minibatch; returns the loss before the last one.
struct Contender {
  std::string name;
  std::function<double(std::size_t minibatch, std::size_t steps)> train;
  double best_s = 1e9;
};

torch::Tensor tensor(const std::vector<float>& values, std::int64_t columns) {
  return torch::tensor(values).view({-1, columns}).contiguous();
}

struct Batch {
  torch::Tensor inputs, targets, counted;

  Batch(const learn::Minibatch& minibatch, const learn::NetworkShape& shape)
      : inputs(tensor(minibatch.inputs, static_cast<std::int64_t>(shape.inputs()))),
        targets(tensor(minibatch.targets, static_cast<std::int64_t>(shape.outputs()))),
        counted(tensor(minibatch.counted, static_cast<std::int64_t>(shape.outputs()))) {}
};

/// The weights [outputs, inputs] and biases of a layer as our state lays them out: [outputs][inputs + 1].
torch::Tensor layer_of(const learn::NetworkState& state, const learn::NetworkShape& shape, std::size_t layer) {
  std::size_t first = 0;
  for (std::size_t l = 0; l < layer; ++l) first += shape.layers[l].parameters();
  const auto& size = shape.layers[layer];
  std::vector<float> values(state.weights.begin() + static_cast<std::ptrdiff_t>(first),
                            state.weights.begin() + static_cast<std::ptrdiff_t>(first + size.parameters()));
  return tensor(values, static_cast<std::int64_t>(size.inputs + 1));
}

/// As in libtorch's tutorials: modules, autograd, optim::Adam.
class Idiomatic {
 public:
  Idiomatic(const learn::NetworkShape& shape, const learn::NetworkState& state) {
    for (std::size_t l = 0; l < shape.layers.size(); ++l) {
      const auto inputs = static_cast<std::int64_t>(shape.layers[l].inputs);
      torch::nn::Linear linear(inputs, static_cast<std::int64_t>(shape.layers[l].outputs));
      {
        const torch::NoGradGuard no_gradient;
        const torch::Tensor values = layer_of(state, shape, l);
        linear->weight.copy_(values.narrow(1, 0, inputs));
        linear->bias.copy_(values.select(1, inputs));
      }
      network_->push_back(linear);
      if (shape.layers[l].activation == learn::Activation::relu) network_->push_back(torch::nn::ReLU());
      if (shape.layers[l].activation == learn::Activation::softplus) network_->push_back(torch::nn::Softplus());
    }
    optimiser_ = std::make_unique<torch::optim::Adam>(
        network_->parameters(),
        torch::optim::AdamOptions(adam.learning_rate).betas({adam.beta1, adam.beta2}).eps(adam.epsilon));
  }

  double train(const Batch& data, std::size_t steps) {
    torch::Tensor loss;
    for (std::size_t i = 0; i < steps; ++i) {
      optimiser_->zero_grad();
      loss = ((network_->forward(data.inputs) - data.targets) * data.counted).square().sum() / batch;
      loss.backward();
      optimiser_->step();
    }
    return loss.item<double>();
  }

 private:
  torch::nn::Sequential network_;
  std::unique_ptr<torch::optim::Adam> optimiser_;
};

/// No autograd, nothing allocated in a step, all parameters in one flat tensor so that Adam is five operations.
class Tuned {
 public:
  Tuned(const learn::NetworkShape& shape, const learn::NetworkState& state) : shape_(shape) {
    const auto count = static_cast<std::int64_t>(shape.parameters());
    parameters_ = torch::empty({count});
    gradients_ = torch::zeros({count});
    first_ = torch::zeros({count});
    second_ = torch::zeros({count});
    divisor_ = torch::empty({count});
    std::int64_t at = 0;
    for (std::size_t l = 0; l < shape.layers.size(); ++l) {
      const auto inputs = static_cast<std::int64_t>(shape.layers[l].inputs);
      const auto outputs = static_cast<std::int64_t>(shape.layers[l].outputs);
      const torch::Tensor values = layer_of(state, shape, l);
      Layer layer;
      layer.weight = parameters_.narrow(0, at, inputs * outputs).view({outputs, inputs});
      layer.weight_gradient = gradients_.narrow(0, at, inputs * outputs).view({outputs, inputs});
      layer.weight.copy_(values.narrow(1, 0, inputs));
      at += inputs * outputs;
      layer.bias = parameters_.narrow(0, at, outputs);
      layer.bias_gradient = gradients_.narrow(0, at, outputs);
      layer.bias.copy_(values.select(1, inputs));
      at += outputs;
      layer.transposed = layer.weight.t();
      layer.output = torch::empty({batch, outputs});
      layer.delta = torch::empty({batch, outputs});
      layer.delta_transposed = layer.delta.t();
      layers_.push_back(std::move(layer));
    }
    slope_ = torch::empty_like(layers_.back().output);
    prediction_ = torch::empty_like(slope_);
  }

  double train(const Batch& data, std::size_t steps) {
    double loss = 0.0;
    for (std::size_t i = 0; i < steps; ++i) {
      forward(data);
      const bool last = i + 1 == steps;
      if (last) loss = ((prediction_ - data.targets) * data.counted).square().sum().item<double>() / batch;
      backward(data);
      update();
    }
    return loss;
  }

 private:
  struct Layer {
    torch::Tensor weight, transposed, bias, weight_gradient, bias_gradient, output, delta, delta_transposed;
  };

  void forward(const Batch& data) {
    const torch::Tensor* input = &data.inputs;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      Layer& layer = layers_[l];
      at::addmm_out(layer.output, layer.bias, *input, layer.transposed);
      if (shape_.layers[l].activation == learn::Activation::relu) layer.output.relu_();
      input = &layer.output;
    }
    at::softplus_out(prediction_, layers_.back().output);
  }

  void backward(const Batch& data) {
    at::sigmoid_out(slope_, layers_.back().output);
    at::sub_out(layers_.back().delta, prediction_, data.targets);
    layers_.back().delta.mul_(data.counted).mul_(slope_).mul_(2.0 / batch);
    for (std::size_t l = layers_.size(); l-- > 0;) {
      Layer& layer = layers_[l];
      at::mm_out(layer.weight_gradient, layer.delta_transposed, l == 0 ? data.inputs : layers_[l - 1].output);
      at::sum_out(layer.bias_gradient, layer.delta, 0);
      if (l == 0) break;
      Layer& below = layers_[l - 1];
      at::mm_out(below.delta, layer.delta, layer.weight);
      if (shape_.layers[l - 1].activation == learn::Activation::relu)
        at::threshold_backward_out(below.delta, below.delta, below.output, 0.0);
    }
  }

  void update() {
    first_.mul_(adam.beta1).add_(gradients_);
    second_.mul_(adam.beta2).addcmul_(gradients_, gradients_);
    at::sqrt_out(divisor_, second_).add_(adam.scaled_epsilon());
    parameters_.addcdiv_(first_, divisor_, -adam.step_size(++steps_));
  }

  learn::NetworkShape shape_;
  std::vector<Layer> layers_;
  torch::Tensor parameters_, gradients_, first_, second_, divisor_, slope_, prediction_;
  std::size_t steps_ = 0;
};

/// All must have learned the same, but for the place of Adam's epsilon: before or after the bias correction.
void check_losses(std::vector<Contender>& contenders) {
  std::vector<double> losses;
  for (Contender& contender : contenders) losses.push_back(contender.train(0, 5));
  for (std::size_t i = 0; i < losses.size(); ++i) {
    if (std::fabs(losses[i] - losses[0]) <= 1e-2 * losses[0]) continue;
    fmt::print(stderr, "{} has loss {} after 5 steps, {} has {}: they do not compute the same\n", contenders[i].name,
               losses[i], contenders[0].name, losses[0]);
    std::exit(1);
  }
  fmt::print("loss after 5 steps: {:.4f} with all of them\n", losses[0]);
}

}  // namespace

int main() {
  torch::set_num_threads(1);
  const learn::NetworkShape shape = learn::dqn_shape(38);
  aloft::RandomStream random(1, 0, "benchmark");
  const learn::NetworkState state = learn::initial_state(shape, random);

  std::vector<learn::Minibatch> ours;
  std::vector<Batch> theirs;
  for (std::size_t i = 0; i < minibatches; ++i) {
    ours.push_back(learn::random_minibatch(shape, batch, learn::Loss::mse, "minibatch " + std::to_string(i)));
    theirs.emplace_back(ours.back(), shape);
  }

  std::vector<Contender> contenders;
  for (const learn::Path path : learn::available_paths()) {
    const std::shared_ptr<learn::Network> network = learn::make_network(shape, adam, path);
    network->load(state);
    const std::string name =
        path == learn::Path::portable ? "Aloft, Eigen" : fmt::format("Aloft, {} kernels", learn::path_name(path));
    contenders.push_back({name, [network, &ours](std::size_t i, std::size_t steps) {
                            return network->train(ours[i], learn::Loss::mse, steps);
                          }});
  }
  std::reverse(contenders.begin(), contenders.end());
  const auto tuned = std::make_shared<Tuned>(shape, state);
  contenders.push_back({"libtorch, tuned", [tuned, &theirs](std::size_t i, std::size_t steps) {
                          const torch::NoGradGuard no_gradient;
                          return tuned->train(theirs[i], steps);
                        }});
  const auto idiomatic = std::make_shared<Idiomatic>(shape, state);
  contenders.push_back({"libtorch, idiomatic", [idiomatic, &theirs](std::size_t i, std::size_t steps) {
                          return idiomatic->train(theirs[i], steps);
                        }});

  torch::globalContext().setFlushDenormal(true);  // for all contenders: without it, libtorch gets slower and slower
  check_losses(contenders);
  for (int turn = 0; turn < turns; ++turn)
    for (Contender& contender : contenders)
      bench::shortest_turn(contender.best_s,
                           [&] { contender.train(static_cast<std::size_t>(turn) % minibatches, steps_per_turn); });

  const double ours_s = contenders.front().best_s;
  fmt::print("{:<24} {:>18} {:>26}\n", "", "us/gradient step", "x " + contenders.front().name);
  for (const Contender& contender : contenders)
    fmt::print("{:<24} {:>18.1f} {:>26.2f}\n", contender.name, contender.best_s / steps_per_turn * 1e6,
               contender.best_s / ours_s);
  return 0;
}
