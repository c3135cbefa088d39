#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "common/agents/height_belief.hpp"
#include "common/base/digest.hpp"
#include "common/base/random.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;

namespace {

constexpr int levels = 4;
constexpr int horizon_steps = 4;

const QualityPrior prior{.mean = 0.5,
                         .slope = 0.03,
                         .common_sd = 0.2,
                         .profile_sd = 0.1,
                         .profile_range = 3.0,
                         .change_sd = 0.15,
                         .change_range = 1.0,
                         .persistence = 0.85,
                         .noise_sd = 0.03};
constexpr double optimism = 0.9;
constexpr double discount = 0.8;

nlohmann::json entry(const std::string& prefix) {
  return {{"type", "height-filter"},
          {prefix + "mean", prior.mean},
          {prefix + "slope", prior.slope},
          {prefix + "common_sd", prior.common_sd},
          {prefix + "profile_sd", prior.profile_sd},
          {prefix + "profile_range", prior.profile_range},
          {prefix + "change_sd", prior.change_sd},
          {prefix + "change_range", prior.change_range},
          {prefix + "persistence", prior.persistence},
          {prefix + "noise_sd", prior.noise_sd},
          {prefix + "optimism", optimism},
          {prefix + "discount", discount},
          {prefix + "horizon_steps", horizon_steps}};
}

/// The value of the best path that is at `level` in step `ahead`, by trying all paths.
double best_path(const HeightBelief& belief, double per_unit, int ahead, int level) {
  std::vector<double> outlook(levels);
  belief.outlook(std::pow(prior.persistence, ahead), per_unit, optimism, outlook);
  double best_rest = 0.0;
  if (ahead < horizon_steps) {
    best_rest = -1e9;
    for (int to = std::max(level - 1, 0); to <= std::min(level + 1, levels - 1); ++to)
      best_rest = std::max(best_rest, best_path(belief, per_unit, ahead + 1, to));
  }
  return outlook[static_cast<std::size_t>(level)] + discount * best_rest;
}

int best_neighbour(const HeightBelief& belief, double per_unit, int here) {
  int best = here;
  for (const int to : {here - 1, here + 1})
    if (to >= 0 && to < levels && best_path(belief, per_unit, 1, to) > best_path(belief, per_unit, 1, best)) best = to;
  return best;
}

}  // namespace

TEST_CASE("height-filter conforms") {
  aloft::flight::check_conformance("height-filter");
}

TEST_CASE("height-filter flies the first action of the best of all plans") {
  std::uint32_t height_changes = 0;
  for (const QosKind kind : {QosKind::spectral_efficiency, QosKind::throughput}) {
    const bool throughput = kind == QosKind::throughput;
    const AgentSpec spec = parse_agents(entry(throughput ? "throughput_" : "se_"), "agents[0]").front();
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      SyntheticMap map = SyntheticMap::random(kind, 40, levels, seed);
      const auto record = aloft::flight::fly(map, 1, 0, *spec.make(), spec);
      height_changes += record.height_changes();
      HeightBelief belief(prior, levels);
      double reward_sum = 0.0;
      int here = 0;
      for (const auto& step : record.steps) {
        INFO("seed " << seed << ", step " << step.step);
        const double mean_unit = reward_sum > 0.0 ? (step.step - 1) / reward_sum : 0.0;
        const int expected = best_neighbour(belief, throughput ? mean_unit : 1.0 / 20.0, here);
        here = static_cast<int>(std::lround((step.height_m - 40.0) / 10.0));
        CHECK(here == expected);
        belief.update(static_cast<std::uint32_t>(here), step.reward);
        reward_sum += step.reward;
      }
    }
  }
  CHECK(height_changes > 50);
}

TEST_CASE("height-filter finds the best height of a hill and stays near it") {
  const aloft::radio::HeightGrid grid{40, 140, 10, 10};
  std::vector<double> hill;
  for (std::uint32_t i = 0; i < grid.size(); ++i) hill.push_back(15.0 - 2.0 * std::fabs(i - 4.0));
  SyntheticMap map(QosKind::spectral_efficiency, grid, std::vector<std::vector<double>>(101, hill));
  const AgentSpec spec = parse_agents("height-filter", "agents[0]").front();
  const auto record = aloft::flight::fly(map, 1, 0, *spec.make(), spec);
  for (std::size_t i = 50; i < 100; ++i) CHECK(std::fabs(record.steps[i].height_m - 80.0) <= 10.0);
}

TEST_CASE("height-filter has the same bits on every machine") {
  // Digests of the agent's state after a flight, covariances included. A new format of states changes them, too.
  const auto digest = [](QosKind kind) {
    const aloft::radio::HeightGrid grid{40, 140, 10, 10};
    aloft::RandomStream random(1, 0, "golden flight");
    std::vector<std::vector<double>> qos(61, std::vector<double>(grid.size()));
    for (auto& column : qos)
      for (double& value : column) value = random.uniform(0.5, 20.0);
    SyntheticMap map(kind, grid, std::move(qos));
    const AgentSpec spec = parse_agents("height-filter", "agents[0]").front();
    const auto agent = spec.make();
    (void)aloft::flight::fly(map, 1, 0, *agent, spec);
    return aloft::sha256_hex(agent->save_state());
  };
  CHECK(digest(QosKind::spectral_efficiency) == "b04405ae6c6115e60110d7bb6e9573977e3d7e30beeadfa5c39da4398bcc26f6");
  CHECK(digest(QosKind::throughput) == "1ec60ea82ac68c0403c350e8b70595d9a947b16fdb757f97c9511b465a673746");
}
