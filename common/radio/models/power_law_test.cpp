#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/radio/testing/link_model_conformance.hpp"

using aloft::radio::mean_gain;
using nlohmann::json;

namespace {

const json defaults = json::object();

}  // namespace

TEST_CASE("the power law is a channel model") {
  for (const char* ray : {"published", "geometric"})
    for (const char* distance : {"slant", "horizontal"})
      aloft::radio::check_link_model("power-law", {{"los_ray", ray}, {"path_distance", distance}});
  aloft::radio::check_link_model("power-law", {{"path_exponent_los", 4}, {"path_exponent_nlos", 8}});
}

TEST_CASE("path gain falls with the exponent") {
  const auto at_100_m = [](const json& world, bool line_of_sight) {
    return mean_gain("power-law", world, 100.0, 30.0, line_of_sight);
  };
  CHECK(at_100_m(defaults, false) == Approx(1e-8).epsilon(1e-14));
  CHECK(at_100_m(defaults, true) == Approx(6.30957344480193e-5).epsilon(1e-13));  // 10^-4.2
  CHECK(at_100_m({{"path_exponent_nlos", 4.0 + 1e-15}}, false) == Approx(at_100_m(defaults, false)).epsilon(1e-13));
}

TEST_CASE("path gain counts the slant or the horizontal distance, 1 m at least") {
  // r = 300 m, h - 30 = 400 m: D = 500 m. 500^-2.1 = 2.1486367e-6; 500^-4 = 1.6e-11; 300^-2.1 = 6.2812397e-6
  CHECK(mean_gain("power-law", defaults, 300.0, 430.0, true) == Approx(2.1486367e-6).epsilon(1e-7));
  CHECK(mean_gain("power-law", defaults, 300.0, 430.0, false) == Approx(1.6e-11).epsilon(1e-14));
  const json horizontal{{"path_distance", "horizontal"}};
  CHECK(mean_gain("power-law", horizontal, 300.0, 430.0, true) == Approx(6.2812397e-6).epsilon(1e-7));
  CHECK(mean_gain("power-law", horizontal, 0.5, 430.0, true) == 1.0);
  CHECK(mean_gain("power-law", defaults, 0.5, 30.5, false) == 1.0);
}
