#include "common/agents/pretrained_state.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace aloft::agents;

namespace {

using Inputs = std::array<float, PretrainedState::inputs>;

Inputs inputs_of(const PretrainedState& state) {
  Inputs inputs{};
  state.encode(inputs);
  return inputs;
}

void check(const Inputs& inputs, std::size_t first, std::initializer_list<double> expected) {
  for (const double value : expected) {
    INFO("input " << first);
    CHECK(static_cast<double>(inputs[first++]) == Approx(value).margin(1e-6));
  }
}

/// The index of the first of an offset's five values.
std::size_t block(int offset) {
  return static_cast<std::size_t>(offset + 6) * 5;
}

}  // namespace

TEST_CASE("the inputs of the pre-trained network equal those computed by hand") {
  // Four levels. Reports: level 0 with 10 bit/s/Hz, then level 1 with 4, then level 0 with 6.
  PretrainedState state(QosKind::spectral_efficiency, 4);
  state.observe({0, 10.0F, {10.0F, 5.0F, 3.0F, 2.0F, 1.0F}});
  state.observe({1, 4.0F, {4.0F, 2.0F, 1.0F, 0.0F, 0.0F}});
  state.observe({0, 6.0F, {6.0F, 1.0F, 0.5F, 0.4F, 0.2F}});
  const Inputs inputs = inputs_of(state);
  for (int offset = -6; offset < 0; ++offset) check(inputs, block(offset), {0, 0, 0, 0, 0});  // below Zmin
  check(inputs, block(0), {0.3, 0.05, 1, 1, 1});
  check(inputs, block(1), {0.2, 0.1, 0.77880078, 0.95122942, 1});  // one step ago: exp(-1/4), exp(-1/20)
  check(inputs, block(2), {0, 0, 0, 0, 1});                        // not visited
  check(inputs, block(3), {0, 0, 0, 0, 1});
  for (int offset = 4; offset <= 6; ++offset) check(inputs, block(offset), {0, 0, 0, 0, 0});  // above the top
  check(inputs, 65, {0.3, 0.05, 0.025, 0.02, 0.01});
  check(inputs, 70, {0.0, 0.3});
  check(inputs, 72, {0.3, -1, 0.2, 1, 0, 0, 0, 0});
  check(inputs, 80, {20.0 / 3.0 / 20.0, 10.0 / 20.0 / 2.0, 0.02});
}

TEST_CASE("the network's inputs are relative to the mean throughput of the flight so far") {
  PretrainedState state(QosKind::throughput, 2);
  state.observe({0, 3'000.0F, {}});
  state.observe({1, 9'000.0F, {}});
  const Inputs inputs = inputs_of(state);
  CHECK(static_cast<double>(state.scale()) == Approx(1.0 / 9'000.0));  // mean 6,000
  check(inputs, block(-1), {1.0 / 3.0, 0, 0.77880078, 0.95122942, 1});
  check(inputs, block(0), {1, 0, 1, 1, 1});
  check(inputs, 65, {0, 0, 0, 0, 0, 0.1, 0.0});
  check(inputs, 72, {1, 1, 0, 0});
  check(inputs, 80, {2.0 / 3.0, 0.5, 0.01});
}

TEST_CASE("the network's inputs stay finite without any throughput") {
  PretrainedState state(QosKind::throughput, 2);
  for (int i = 0; i < 500; ++i) state.observe({0, 0.0F, {}});
  for (const float input : inputs_of(state)) CHECK(std::isfinite(input));
}

TEST_CASE("the network's reports hold SINRs of generated worlds and none of measured ones") {
  Observation observation;
  observation.qos = 2.0;
  observation.serving_sinr_db = 10.0 * std::log10(3.0);
  observation.neighbour_count = 2;
  observation.neighbour_sinr_db = {0.0, -200.0};
  const PretrainedReport generated = pretrained_report(QosKind::spectral_efficiency, 3, observation);
  CHECK(generated.level == 3);
  CHECK(static_cast<double>(generated.qos) == 2.0);
  CHECK(static_cast<double>(generated.se[0]) == Approx(2.0));
  CHECK(static_cast<double>(generated.se[1]) == Approx(1.0));
  CHECK(static_cast<double>(generated.se[2]) == Approx(0.0).margin(1e-6));
  CHECK(pretrained_report(QosKind::throughput, 3, observation).se == std::array<float, max_neighbours>{});
}
