#include "common/learn/reference.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/learn/test_networks.hpp"

using namespace aloft::learn;  // NOLINT(google-build-using-namespace): a test of this namespace

namespace {

using Reference = ReferenceNetwork<double>;

std::vector<double> random_weights(const NetworkShape& shape) {
  aloft::RandomStream random(11, 0, "weights");
  std::vector<double> weights(shape.parameters());
  for (double& w : weights) w = random.uniform(-0.6, 0.6);  // biases too, so that their gradients are tested
  return weights;
}

/// The largest difference between the gradient and central differences of the loss.
double gradient_error(const NetworkShape& shape, Loss loss) {
  const Minibatch batch = random_minibatch(shape, 16, loss, "finite differences");
  std::vector<double> weights = random_weights(shape);
  Reference network(shape, {});
  std::vector<double> gradient;
  network.load(weights, {}, {}, 0);
  network.gradient(batch, loss, gradient);
  double worst = 0.0;
  const double h = 1e-5;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double w = weights[i];
    const auto loss_at = [&](double x) {
      weights[i] = x;
      network.load(weights, {}, {}, 0);
      return network.loss(batch, loss);
    };
    const double slope = (loss_at(w + h) - loss_at(w - h)) / (2 * h);
    weights[i] = w;
    worst = std::max(worst, std::fabs(slope - gradient[i]));
  }
  return worst;
}

}  // namespace

TEST_CASE("the paper's network has the published number of parameters") {
  CHECK(dqn_shape(38).parameters() == 90524);
  CHECK(dqn_shape(18).layers.front().outputs == 19);
}

TEST_CASE("gradients agree with finite differences") {
  const NetworkShape shape = dqn_shape(6, 16, 3);
  CHECK(gradient_error(shape, Loss::mse) < 1e-8);
  CHECK(gradient_error(shape, Loss::cross_entropy) < 1e-8);
}

TEST_CASE("a network small enough for pencil and paper") {
  // h = relu(2 x1 - 1 x2 + 0.5), q = (3 h + 1, -h, 2); samples (1, 1): h = 1.5, q = (5.5, -1.5, 2);
  // (0, 2): h = 0 (sum -1.5), q = (1, 0, 2).
  const NetworkShape shape{{{2, 1, Activation::relu}, {1, 3, Activation::linear}}};
  const std::vector<double> weights{2, -1, 0.5, 3, 1, -1, 0, 0, 2};
  Reference network(shape, {});
  network.load(weights, {}, {}, 0);
  Reference::Matrix inputs(2, 2);
  inputs << 1, 0, 1, 2;
  Reference::Matrix expected(3, 2);
  expected << 5.5, 1, -1.5, 0, 2, 2;
  CHECK(network.predict(inputs) == expected);

  // mse on q1 of sample 1 (target 5: error 0.5) and q3 of sample 2 (target 4: error -2); mean over the 2 samples:
  // (0.25 + 4) / 2. dL/dq = error, so dW3 = 0.5 (h, 1) for output 1, -2 (0, 1) for output 3, dh = 3 * 0.5 = 1.5 times
  // the inputs of sample 1.
  const Minibatch batch{2, {1, 1, 0, 2}, {5, 0, 0, 0, 0, 4}, {1, 0, 0, 0, 0, 1}};
  std::vector<double> gradient;
  CHECK(network.gradient(batch, Loss::mse, gradient) == 2.125);
  CHECK(gradient == std::vector<double>{1.5, 1.5, 1.5, 0.75, 0.5, 0, 0, 0, -2});
}

TEST_CASE("cross-entropy normalises the outputs as the published code does") {
  // Outputs (1, 2, 1) whatever the input: p = (1/4, 1/2, 1/4); label 2: loss ln 2, dL/dq = 1/4 - (0, 1/2, 0).
  const NetworkShape shape{{{1, 3, Activation::linear}}};
  Reference network(shape, {});
  network.load(std::vector<double>{0, 1, 0, 2, 0, 1}, {}, {}, 0);
  std::vector<double> gradient;
  const Minibatch batch{1, {3}, {0, 1, 0}, {0, 0, 0}};
  CHECK(network.gradient(batch, Loss::cross_entropy, gradient) == Approx(std::log(2.0)).epsilon(1e-15));
  CHECK(gradient == std::vector<double>{0.75, 0.25, -0.75, -0.25, 0.75, 0.25});

  // A label's probability below 1e-7 is clipped: the loss is finite, the gradient zero.
  network.load(std::vector<double>{0, 1, 0, 1e-9, 0, 1}, {}, {}, 0);
  CHECK(network.gradient(batch, Loss::cross_entropy, gradient) == Approx(-std::log(1e-7)).epsilon(1e-12));
  CHECK(gradient == std::vector<double>(6, 0.0));
}

TEST_CASE("softplus stays finite and accurate far from zero") {
  const NetworkShape shape{{{1, 1, Activation::softplus}}};
  Reference network(shape, {});
  network.load(std::vector<double>{1, 0}, {}, {}, 0);
  Reference::Matrix inputs(1, 4);
  inputs << 0, 500, -30, -1000;
  const Reference::Matrix q = network.predict(inputs);
  CHECK(q(0, 0) == Approx(std::log(2.0)).epsilon(1e-15));
  CHECK(q(0, 1) == 500);
  CHECK(q(0, 2) == Approx(9.357622968839737e-14).epsilon(1e-14));  // log1p(exp(-30))
  CHECK(q(0, 3) == 0);
}

TEST_CASE("Adam is Keras' Adam") {
  const NetworkShape shape = dqn_shape(3, 8, 1);
  const Minibatch batch = random_minibatch(shape, 16, Loss::mse, "adam");
  Reference network(shape, {});
  std::vector<double> weights = random_weights(shape);
  network.load(weights, {}, {}, 0);
  // Textbook form with plain moments; the network under test keeps scaled ones.
  std::vector<double> m(weights.size(), 0.0);
  std::vector<double> v(weights.size(), 0.0);
  Reference textbook(shape, {});
  for (int t = 1; t <= 20; ++t) {
    std::vector<double> g;
    textbook.load(weights, {}, {}, 0);
    textbook.gradient(batch, Loss::mse, g);
    const double rate = 1e-3 * std::sqrt(1 - std::pow(0.999, t)) / (1 - std::pow(0.9, t));
    for (std::size_t i = 0; i < weights.size(); ++i) {
      m[i] = 0.9 * m[i] + 0.1 * g[i];
      v[i] = 0.999 * v[i] + 0.001 * g[i] * g[i];
      weights[i] -= rate * m[i] / (std::sqrt(v[i]) + 1e-7);
    }
    network.step(batch, Loss::mse);
  }
  const std::vector<double> trained = network.weights();
  for (std::size_t i = 0; i < weights.size(); ++i) CHECK(trained[i] == Approx(weights[i]).margin(1e-12));
}

TEST_CASE("shapes that make no sense are refused") {
  CHECK_THROWS_AS(Reference(NetworkShape{}, {}), std::logic_error);
  CHECK_THROWS_AS(Reference(NetworkShape{{{2, 3, Activation::relu}, {4, 1, Activation::linear}}}, {}),
                  std::logic_error);
  CHECK_THROWS_AS(Reference(NetworkShape{{{2, 3, Activation::softplus}, {3, 1, Activation::linear}}}, {}),
                  std::logic_error);
  Reference network(dqn_shape(3, 8, 1), {});
  CHECK_THROWS_AS(network.loss(Minibatch{1, {1}, {0, 0, 0}, {0, 0, 0}}, Loss::mse), std::logic_error);
}
