#include "common/agents/dqn_encoder.hpp"

#include <catch2/catch.hpp>
#include <vector>

using namespace aloft::agents;  // NOLINT(google-build-using-namespace): a test of this namespace

namespace {

const FlightInfo generated{QosKind::spectral_efficiency, 40, 240, 10, 100, 1, 0};
const FlightInfo measured{QosKind::throughput, 20, 120, 10, 170, 1, 0};

Observation report(std::uint32_t step, double height_m, double sinr_db, double reward) {
  Observation observation;
  observation.step = step;
  observation.height_m = height_m;
  observation.serving_sinr_db = sinr_db;
  observation.neighbour_count = 5;
  observation.neighbour_sinr_db = {-10, -12, -14, -16, -18};
  observation.reward = reward;
  return observation;
}

std::size_t inputs(const DqnEncoder::Settings& settings, const FlightInfo& flight) {
  DqnEncoder encoder(settings);
  encoder.begin(flight);
  return encoder.inputs();
}

}  // namespace

TEST_CASE("the state is as wide as published") {
  CHECK(inputs({}, generated) == 38);
  CHECK(inputs({.neighbours = 5}, generated) == 43);
  CHECK(inputs({}, measured) == 18);
}

TEST_CASE("the state lists reports, actions and rewards newest first") {
  DqnEncoder encoder({.history = 2});
  encoder.begin(generated);
  encoder.observe(report(0, 40, 20, 0));
  encoder.observe(report(1, 50, 10, 3));
  CHECK_FALSE(encoder.complete());
  encoder.observe(report(2, 50, 4, 5));
  REQUIRE(encoder.complete());
  const std::vector<float> expected{
      0.2F, -0.5F, -0.6F, -0.7F, -0.8F, 0.05F,              // now: 4 dB at 50 m of 40..240
      0.5F, -0.5F, -0.6F, -0.7F, -0.8F, 0.05F, 0.0F, 5.0F,  // 10 dB, held, got 5
      1.0F, -0.5F, -0.6F, -0.7F, -0.8F, 0.0F,  1.0F, 3.0F,  // 20 dB at 40 m, went up, got 3
  };
  CHECK(encoder.state() == expected);
  CHECK(encoder.reward() == 5.0F);
  encoder.observe(report(3, 40, 4, 1));
  CHECK(encoder.state()[12] == -1.0F);
  CHECK(encoder.state().size() == expected.size());
}

TEST_CASE("linear inputs are relative to the largest SINR seen") {
  DqnEncoder encoder({.history = 1, .input_scaling = DqnEncoder::InputScaling::linear_max});
  encoder.begin(measured);
  encoder.observe(report(0, 20, 20, 0));
  encoder.observe(report(1, 30, 10, 40000));
  // 10 dB is a tenth of 20 dB; 40,000 kbit/s is 40 Mbit/s.
  CHECK(encoder.state() == std::vector<float>{0.1F, 0.1F, 1.0F, 0.0F, 1.0F, 40.0F});
}

TEST_CASE("rewards: absolute, scaled by the largest seen, or the change") {
  const auto rewards = [](DqnEncoder::Reward kind) {
    DqnEncoder encoder({.reward = kind});
    encoder.begin(generated);
    encoder.observe(report(0, 40, 0, 0));
    std::vector<float> values;
    for (std::uint32_t step = 1; step <= 4; ++step) {
      const std::vector<double> reward{0, 4, 8, 2, 3};
      encoder.observe(report(step, 40, 0, reward[step]));
      values.push_back(encoder.reward());
    }
    return values;
  };
  CHECK(rewards(DqnEncoder::Reward::absolute) == std::vector<float>{4, 8, 2, 3});
  CHECK(rewards(DqnEncoder::Reward::scaled) == std::vector<float>{1, 1, 0.25F, 0.375F});
  CHECK(rewards(DqnEncoder::Reward::difference) == std::vector<float>{0, 4, -6, 1});
}
