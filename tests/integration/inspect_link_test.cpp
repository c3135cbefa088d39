#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/integration/command.hpp"

using aloft::test::Finished;
using aloft::test::run_command;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

Finished inspect(const std::string& model, const std::string& height_m, const std::string& distance_m,
                 const std::string& carrier_ghz, const std::string& format) {
  return run_command({"aloft", "inspect", "link", "--model", model, "--height", height_m, "--distance", distance_m,
                      "--carrier", carrier_ghz, "--format", format});
}

Json link(const std::string& model, const std::string& height_m, const std::string& distance_m,
          const std::string& carrier_ghz) {
  const Finished finished = inspect(model, height_m, distance_m, carrier_ghz, "json");
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  return Json::parse(finished.out);
}

}  // namespace

TEST_CASE("inspect link gives the values of TR 36.777") {
  const Json urban = link("uma-av", "30", "500", "2");
  CHECK(urban["p_los"] == Approx(0.828456).margin(1e-6));
  CHECK(urban["path_loss_los_db"] == Approx(93.3984).margin(1e-4));
  CHECK(urban["path_loss_nlos_db"] == Approx(117.2088).margin(1e-4));
  CHECK(urban["shadow_los_db"] == Approx(3.8065).margin(1e-4));
  CHECK(urban["shadow_nlos_db"] == Approx(6.0));
  CHECK_THAT(inspect("uma-av", "30", "500", "2", "text").out, Contains("0.8285") && Contains("117.21"));
}

TEST_CASE("inspect link knows the channel models of generated worlds") {
  // Exponents 2.1 and 4 over the slant distance, from free space at 1 m.
  const Json low = link("power-law", "40", "1000", "3.5");
  const double slant_m = std::hypot(1000.0, 10.0);
  const double at_1_m_db = 20.0 * std::log10(4.0 * std::numbers::pi * 3.5e9 / 3e8);
  CHECK(low["path_loss_los_db"] == Approx(at_1_m_db + 21.0 * std::log10(slant_m)).margin(1e-6));
  CHECK(low["path_loss_nlos_db"] == Approx(at_1_m_db + 40.0 * std::log10(slant_m)).margin(1e-6));
  CHECK(low["shadow_los_db"] == 0.0);
  const Json high = link("power-law", "200", "1000", "3.5");
  CHECK((low["p_los"] > 0.0 && low["p_los"] < high["p_los"] && high["p_los"] < 1.0));
  CHECK(link("power-law", "40", "0", "3.5")["p_los"] == 1.0);
}

TEST_CASE("inspect link refuses what the standard does not cover, and names the range") {
  const Finished carrier = inspect("rma-av", "60", "1000", "60", "json");
  CHECK(carrier.exit_code == 2);
  CHECK(carrier.out.empty());
  CHECK_THAT(carrier.err, Contains("--carrier 60") && Contains("0.7 to 30"));
  const Finished height = inspect("uma-av", "400", "1000", "2", "json");
  CHECK(height.exit_code == 2);
  CHECK_THAT(height.err, Contains("--height 400") && Contains("1.5 to 300"));
  const Finished below = inspect("power-law", "20", "1000", "2", "json");
  CHECK(below.exit_code == 2);
  CHECK_THAT(below.err, Contains("30 to"));
  CHECK(inspect("umi-av", "60", "5000", "2", "json").exit_code == 2);
  const Finished model = inspect("uma", "60", "1000", "2", "json");
  CHECK(model.exit_code == 2);
  CHECK_THAT(model.err, Contains("uma-av"));
}
