#include "tools/train/rollout.hpp"

#include <catch2/catch.hpp>

#include "common/agents/pretrained_model.hpp"
#include "common/base/random.hpp"

using namespace aloft;
using train::Field;
using train::Walker;

namespace {

/// Three levels, four steps; the quality of step s at level k is `qos[s - 1][k]`.
Field hand_made() {
  const double qos[4][3] = {{1, 2, 4}, {8, 0, 1}, {3, 5, 7}, {2, 6, 9}};
  Field field{radio::QosKind::throughput, 3, 4, 0, {}};
  for (const auto& row : qos)
    for (std::uint32_t k = 0; k < 3; ++k) field.reports.push_back({k, static_cast<float>(row[k]), {}});
  return field;
}

/// A network whose output is always (0, 1, 0): it holds.
std::unique_ptr<learn::Network> holding() {
  const learn::NetworkShape shape = agents::pretrained_shape(1);
  std::vector<float> weights(shape.parameters(), 0.0F);
  weights[weights.size() - 3] = 1.0F;  // the last three rows are weight, bias: the middle bias
  auto network = learn::make_network(shape, {});
  network->load({weights, {}, {}, 0});
  return network;
}

}  // namespace

TEST_CASE("a walker flies level by level and stays inside") {
  const Field field = hand_made();
  Walker walker(field);
  CHECK(walker.level_after(0) == 0);
  CHECK(walker.fly(0) == 1.0);
  CHECK(walker.fly(2) == 0.0);
  CHECK(walker.fly(2) == 7.0);
  CHECK(walker.level_after(2) == 2);
  CHECK_FALSE(walker.finished());
  CHECK(walker.fly(2) == 9.0);
  CHECK(walker.finished());
}

TEST_CASE("the best values are those of the best of all feasible flights, by hand") {
  const std::vector<double> values = best_values(hand_made(), 1.0);
  REQUIRE(values.size() == 5 * 3);
  for (int k = 0; k < 3; ++k) CHECK(values[static_cast<std::size_t>(4 * 3 + k)] == 0.0);
  CHECK(values[3 * 3 + 0] == 6.0);  // before step 4, level 0: up to 6
  CHECK(values[3 * 3 + 1] == 9.0);
  CHECK(values[2 * 3 + 0] == 14.0);             // 5 + 9
  CHECK(values[1 * 3 + 0] == 8.0 + 14.0);       // hold
  CHECK(values[1 * 3 + 2] == 1.0 + 7.0 + 9.0);  // 1 and then 7 + 9, or 0 + 16
  CHECK(values[0] == 2.0 + 8.0 + 14.0);         // up, down, up, up
  // Half of each later step.
  const std::vector<double> discounted = best_values(hand_made(), 0.5);
  CHECK(discounted[2 * 3 + 0] == 5.0 + 0.5 * 9.0);
}

TEST_CASE("rollouts sum what follows each action when the policy goes on") {
  const Field field = hand_made();
  const auto network = holding();
  train::GreedyPolicy policy(*network);
  std::vector<Walker> walkers{Walker(field), Walker(field)};
  REQUIRE(policy.choose(walkers)[0] == 1);
  walkers[1].fly(2);
  walkers[1].fly(2);  // at level 2, two steps left
  const std::vector<double> returns = train::roll_out(walkers, policy, {0.5, 3});
  // From the start: hold or down 1 + 8/2 + 3/4, up 2 + 0/2 + 5/4.
  CHECK(returns[0] == 5.75);
  CHECK(returns[1] == 5.75);
  CHECK(returns[2] == 3.25);
  // From level 2 with two steps left: down 5 + 6/2, hold or up 7 + 9/2.
  CHECK(returns[3] == 8.0);
  CHECK(returns[4] == 11.5);
  CHECK(returns[5] == 11.5);
}

TEST_CASE("samples hold the centred, scaled values of the actions") {
  const Field field = hand_made();
  Walker walker(field);
  walker.fly(1);
  train::Samples samples;
  samples.add(walker.state(), {3.0, 6.0, 0.0});
  REQUIRE(samples.size() == 1);
  const float s = walker.state().scale();  // mean of 1 and 1: 1 / 1.5
  CHECK(s == Approx(1.0 / 1.5));
  CHECK(samples.targets[0] == Approx(0.0F));
  CHECK(samples.targets[1] == Approx(3.0F * s));
  CHECK(samples.targets[2] == Approx(-3.0F * s));
  train::Samples twice = samples;
  twice.append(samples);
  CHECK(twice.size() == 2);
  CHECK(twice.inputs.size() == 2 * agents::PretrainedState::inputs);
}

TEST_CASE("training fields are functions of seed and trial within their bounds") {
  const Field field = train::random_throughput_field(3, 7);
  CHECK(field.reports.size() == std::size_t{field.levels} * field.steps);
  CHECK(train::random_throughput_field(3, 7).reports[5].qos == field.reports[5].qos);
  CHECK(train::random_throughput_field(3, 8).reports[5].qos != field.reports[5].qos);
  for (const auto& report : field.reports) CHECK(report.qos >= 0.0F);
  const Field city = train::generated_field(2.5, 3, 7);
  CHECK(city.levels == 21);
  CHECK(city.steps == 100);
  CHECK(city.report(1, 0).se[0] > 0.0F);
}
