#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/statistics/agent_means.hpp"

using namespace aloft::statistics;

namespace {

/// The built-in model was trained and chosen on other seeds.
void check_gain(const Densities& densities, double least) {
  INFO(densities.bs_per_km2 << " BS, " << densities.buildings_per_km2 << " buildings per km2");
  CHECK(gain_over_min_height("pretrained", world_with(densities), 300).mean >= least);
}

}  // namespace

TEST_CASE("pretrained beats min-height at every density, 300 fresh trials") {
  check_gain({1, 200}, 0.4);
  check_gain({2.5, 200}, 2.3);
  check_gain({5, 200}, 3.8);
  check_gain({2.5, 100}, 2.0);
  check_gain({2.5, 300}, 2.0);
}
