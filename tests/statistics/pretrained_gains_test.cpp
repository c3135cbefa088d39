#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/statistics/agent_means.hpp"

using namespace aloft::statistics;

namespace {

/// The built-in model was trained and chosen on other seeds.
void check_gain(const Densities& densities, double least) {
  const auto means = fly_trials(densities, {"min-height", "pretrained"}, 300);
  std::vector<double> gains;
  for (std::size_t trial = 0; trial < means[0].size(); ++trial) gains.push_back(means[1][trial] - means[0][trial]);
  const Sample gain = sample_of(gains);
  std::cout << fmt::format("pretrained - min-height, {} BS and {} buildings per km2: {:+.3f} +- {:.3f}\n",
                           densities.bs_per_km2, densities.buildings_per_km2, gain.mean,
                           gain.sd / std::sqrt(gain.trials));
  INFO(densities.bs_per_km2 << " BS, " << densities.buildings_per_km2 << " buildings per km2");
  CHECK(gain.mean >= least);
}

}  // namespace

TEST_CASE("pretrained beats min-height at every density, 300 fresh trials") {
  check_gain({1, 200}, 0.4);
  check_gain({2.5, 200}, 2.3);
  check_gain({5, 200}, 3.8);
  check_gain({2.5, 100}, 2.0);
  check_gain({2.5, 300}, 2.0);
}
