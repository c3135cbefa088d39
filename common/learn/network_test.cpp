#include "common/learn/network.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/learn/denormals.hpp"
#include "common/learn/test_networks.hpp"

using namespace aloft::learn;  // NOLINT(google-build-using-namespace): a test of this namespace

TEST_CASE("initial weights are Glorot-uniform, biases zero") {
  const NetworkShape shape{{{64, 200, Activation::linear}}};
  aloft::RandomStream random(1, 2, "init");
  const NetworkState state = initial_state(shape, random);
  const double limit = std::sqrt(6.0 / 264.0);
  double largest = 0;
  double sum = 0;
  double squares = 0;
  for (std::size_t o = 0; o < 200; ++o) {
    for (std::size_t i = 0; i < 64; ++i) {
      const auto w = static_cast<double>(state.weights[o * 65 + i]);
      largest = std::max(largest, std::fabs(w));
      sum += w;
      squares += w * w;
    }
    REQUIRE(state.weights[o * 65 + 64] == 0.0F);
  }
  CHECK(largest < limit * (1 + 1e-7));
  CHECK(largest > 0.99 * limit);
  CHECK(std::fabs(sum / 12800) < 3 * limit / std::sqrt(3.0 * 12800));
  CHECK(squares / 12800 == Approx(limit * limit / 3).epsilon(0.03));
  CHECK(state.first_moments == std::vector<float>(13000, 0.0F));
  CHECK(state.steps == 0);
}

TEST_CASE("denormals are flushed only while the guard lives") {
  volatile float tiny = std::numeric_limits<float>::min();
  CHECK(tiny * 0.5F > 0.0F);
#if defined(__SSE2__)
  {
    const FlushDenormals guard;
    CHECK(tiny * 0.5F == 0.0F);
  }
#endif
  CHECK(tiny * 0.5F > 0.0F);
}

TEST_CASE("every path fits a minibatch, and saving and loading changes nothing") {
  const NetworkShape shape = dqn_shape(18, 40, 3);
  for (const Path path : available_paths()) {
    for (const Loss loss : {Loss::mse, Loss::cross_entropy}) {
      INFO(path_name(path));
      const Minibatch batch = random_minibatch(shape, 16, loss, "fit");
      aloft::RandomStream random(3, 0, "init");
      const auto network = make_network(shape, {}, path);
      network->load(initial_state(shape, random));
      const double before = network->train(batch, loss, 1);
      const double after = network->train(batch, loss, 300);
      CHECK(after < 0.2 * before);

      const auto copy = make_network(shape, {}, path);
      copy->load(network->state());
      CHECK(copy->state().weights == network->state().weights);
      CHECK(copy->train(batch, loss, 5) == network->train(batch, loss, 5));
      CHECK(copy->state().weights == network->state().weights);
      CHECK(copy->state().second_moments == network->state().second_moments);
      CHECK(copy->state().steps == 306);
    }
  }
}

TEST_CASE("a sample's prediction does not depend on the other samples of its batch") {
  const NetworkShape shape = dqn_shape(18, 40, 3);
  const Minibatch batch = random_minibatch(shape, 13, Loss::mse, "predict");
  for (const Path path : available_paths()) {
    INFO(path_name(path));
    aloft::RandomStream random(3, 0, "init");
    const auto network = make_network(shape, {}, path);
    network->load(initial_state(shape, random));
    std::vector<float> inputs;
    for (int i = 0; i < 3; ++i) inputs.insert(inputs.end(), batch.inputs.begin(), batch.inputs.end());
    std::vector<float> together(39 * 3);
    network->predict(inputs, together);
    for (std::size_t s = 0; s < 39; ++s) {
      std::vector<float> alone(3);
      network->predict(std::span<const float>(inputs).subspan(18 * s, 18), alone);
      for (std::size_t k = 0; k < 3; ++k) CHECK(alone[k] == Approx(together[3 * s + k]).epsilon(1e-6));
    }
  }
}
