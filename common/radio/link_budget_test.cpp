#include "common/radio/link_budget.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <vector>

#include "common/radio/generated_world.hpp"
#include "common/radio/height_rows.hpp"

using namespace aloft::radio;
using nlohmann::json;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

RadioModel model_of(const json& given = json::object()) {
  return RadioModel(resolve_generated_world(given, "world"));
}

}  // namespace

TEST_CASE("a beam of 45 degrees has gain 81.49") {
  // 16 pi / (pi/4)^2 = 256 / pi
  CHECK(beam_gain(std::numbers::pi / 4) == Approx(81.4873308630504).epsilon(1e-12));
}

TEST_CASE("near-field gain at 3.5 GHz") {
  // 3e8 / (4 pi 3.5e9) = 0.0068209261; squared
  CHECK(near_field_gain(3.5e9) == Approx(4.6525033e-5).epsilon(1e-7));
}

TEST_CASE("noise in 20 MHz with a noise figure of 10 dB") {
  // -174 + 73.0103 + 10 = -90.9897 dBm = 7.9621e-10 mW
  CHECK(noise_power_w(20e6, 10.0) == Approx(7.96214341e-13).epsilon(1e-8));
}

TEST_CASE("the array's gain by elevation") {
  CHECK(array_gain(0.0) == 8.0);
  // s = 0.1: sin(0.4 pi) = 0.951057, sin(0.05 pi) = 0.156434: 6.0795843^2 / 8
  CHECK(array_gain(0.01) == Approx(4.6201681).epsilon(1e-6));
  // s = 0.8: sin(3.2 pi) = -0.587785, sin(0.4 pi) = 0.951057: 0.618034^2 / 8 = 0.381966 / 8
  CHECK(array_gain(0.64) == Approx(0.04774575).epsilon(1e-6));
  // nulls: sin(4 pi s) = 0 at multiples of 1/4
  for (const double s : {0.25, 0.5, 0.75, 1.0}) CHECK(array_gain(s * s) == Approx(0.0).margin(1e-28));
  // the definition, everywhere
  for (int i = 1; i < 1000; ++i) {
    const double s = i / 1000.0;
    const double ratio = std::sin(4 * std::numbers::pi * s) / std::sin(0.5 * std::numbers::pi * s);
    CHECK(array_gain(s * s) == Approx(ratio * ratio / 8).margin(1e-13));
  }
}

TEST_CASE("received power of one link") {
  // r = 300 m, h - 30 = 400 m: D = 500 m, s = 0.8, g = 0.04774575.
  // 40 * 81.48733 * 4.6525033e-5 = 0.15164803; * g = 0.0072405492; * 500^-2.1 = 2.1486367e-6
  const RadioModel model = model_of();
  CHECK(received_power_w<BsAntenna::array>(model, 300.0, 400.0, 0.0, 2.1486367e-6) ==
        Approx(1.5557310e-8).epsilon(1e-7));
  // without line of sight: 500^-4 = 1.6e-11
  CHECK(received_power_w<BsAntenna::array>(model, 300.0, 400.0, 0.0, 1.6e-11) ==
        Approx(0.0072405492 * 1.6e-11).epsilon(1e-6));
  // A sector of 81.49 instead of array and UAV beam, horizontal distance: 40 * 81.48733 * 4.6525033e-5 * 300^-2.1
  const RadioModel text = model_of({{"preset", "paper-text"}});
  CHECK(received_power_w<BsAntenna::sector>(text, 300.0, 400.0, 0.0, 6.2812397e-6) ==
        Approx(0.15164803 * 6.2812397e-6).epsilon(1e-7));
}

TEST_CASE("the beam's limits on the ground") {
  const RadioModel model = model_of();
  const double degree = std::numbers::pi / 180;
  // theta = 5.71 degrees: less than half the beam, so the beam reaches the horizon
  BeamLimits limits = beam_limits(model, 100.0, 10.0);
  CHECK(limits.nearest_m == Approx(10.0 / std::tan(std::atan2(10.0, 100.0) + 22.5 * degree)).epsilon(1e-12));
  CHECK(limits.nearest_m == Approx(18.640).epsilon(1e-3));
  CHECK(limits.farthest_m == 3000.0);
  // theta = 45 degrees: 100 / tan 67.5 and 100 / tan 22.5
  limits = beam_limits(model, 100.0, 100.0);
  CHECK(limits.nearest_m == Approx(41.4213562).epsilon(1e-8));
  CHECK(limits.farthest_m == Approx(241.4213562).epsilon(1e-8));
  // theta = 84.3 degrees: beyond 67.5
  limits = beam_limits(model, 10.0, 100.0);
  CHECK(limits.nearest_m == 0.0);
  CHECK(limits.farthest_m == 100.0);
  CHECK_FALSE(limits.contain(100.5));
  CHECK(limits.contain(100.0));
}

TEST_CASE("azimuths within half the beam interfere") {
  const RadioModel model = model_of();
  const auto link = [](double azimuth_deg, double distance_m) {
    const double azimuth = azimuth_deg * std::numbers::pi / 180;
    return Link{distance_m * std::cos(azimuth), distance_m * std::sin(azimuth), distance_m};
  };
  CHECK(same_azimuth(model, link(170, 100), link(-168, 900)));
  CHECK_FALSE(same_azimuth(model, link(170, 100), link(-167, 900)));
}

TEST_CASE("spectral efficiency and decibels") {
  CHECK(spectral_efficiency(0.0, infinity) == 0.0);
  CHECK(spectral_efficiency(1023.0, infinity) == Approx(10.0).epsilon(1e-14));
  CHECK(spectral_efficiency(1023.0, 7.4) == 7.4);
  CHECK(spectral_efficiency(3.0, 7.4) == Approx(2.0).epsilon(1e-14));
  CHECK(decibel(100.0) == Approx(20.0).epsilon(1e-14));
  CHECK(decibel(0.0) == Approx(-200.0).epsilon(1e-14));
}

TEST_CASE("the antenna element of TR 38.901: 8 dBi, 65 degrees, 30 dB, tilted down") {
  const auto gain_db = [](double downtilt_deg, double distance_m, double rise_m, double azimuth_deg) {
    const RadioModel model = model_of({{"bs_antenna", "3gpp"}, {"bs_downtilt_deg", downtilt_deg}});
    const double azimuth =
        azimuth_deg * std::numbers::pi / 180.0;  // of the UAV, seen from the antenna; its boresight: x
    const Link link{-distance_m * std::cos(azimuth), -distance_m * std::sin(azimuth), distance_m};
    return 10.0 * std::log10(element_gain(model, distance_m, rise_m, azimuth_loss_db(link, {1.0, 0.0})));
  };
  CHECK(gain_db(0, 100, 0, 0) == Approx(8.0));
  CHECK(gain_db(0, 100, 0, 32.5) == Approx(5.0));  // half the beamwidth: 3 dB less
  CHECK(gain_db(0, 100, 0, -32.5) == Approx(5.0));
  CHECK(gain_db(0, 100, 0, 60) == Approx(8.0 - 12.0 * 60 * 60 / 4225));
  CHECK(gain_db(0, 100, 0, 120) == Approx(8.0 - 30.0));  // 12 (120/65)^2 = 40.9
  CHECK(gain_db(0, 100, 0, 180) == Approx(8.0 - 30.0));
  CHECK(gain_db(0, 100, 100, 0) == Approx(8.0 - 12.0 * 45 * 45 / 4225));
  CHECK(gain_db(10, 100, 0, 0) == Approx(8.0 - 12.0 * 100 / 4225));
  CHECK(gain_db(10, 100, 100, 30) == Approx(8.0 - 12.0 * (55 * 55 + 30 * 30) / 4225));
  CHECK(gain_db(10, 0, 100, 0) == Approx(8.0 - 12.0 * 100 * 100 / 4225));  // right above
  CHECK(gain_db(30, 0, 100, 0) == Approx(8.0 - 30.0));
}

TEST_CASE("no power exceeds its bound") {
  constexpr double gain = 1e-8;
  const RadioModel array = model_of();
  const RadioModel sector = model_of({{"preset", "paper-text"}});
  const RadioModel element = model_of({{"bs_antenna", "3gpp"}});
  for (double distance_m = 0.0; distance_m < 3000.0; distance_m += 7.0)
    for (double rise_m = 0.0; rise_m < 300.0; rise_m += 11.0) {
      REQUIRE(received_power_w<BsAntenna::array>(array, distance_m, rise_m, 0.0, gain) <= power_bound_w(array, gain));
      REQUIRE(received_power_w<BsAntenna::sector>(sector, distance_m, rise_m, 0.0, gain) <=
              power_bound_w(sector, gain));
      REQUIRE(received_power_w<BsAntenna::tr_38_901>(element, distance_m, rise_m, 0.0, gain) <=
              power_bound_w(element, gain));
    }
}

TEST_CASE("rows have the same bits as the formulas, whatever the vector width") {
  const auto power = [](const RadioModel& model, double rise_m, double loss_db, double gain) {
    if (model.bs_antenna == BsAntenna::array)
      return received_power_w<BsAntenna::array>(model, 321.0, rise_m, loss_db, gain);
    if (model.bs_antenna == BsAntenna::sector)
      return received_power_w<BsAntenna::sector>(model, 321.0, rise_m, loss_db, gain);
    return received_power_w<BsAntenna::tr_38_901>(model, 321.0, rise_m, loss_db, gain);
  };
  for (const char* antenna : {"array", "sector", "3gpp"}) {
    const RadioModel model = model_of({{"bs_antenna", antenna}});
    std::vector<double> rise_m(203);
    std::iota(rise_m.begin(), rise_m.end(), 10.0);
    std::vector<double> gain(rise_m.size());
    for (std::size_t i = 0; i < gain.size(); ++i) gain[i] = 1.0 / (rise_m[i] * (i < 57 ? 7e7 : 3e5));
    std::vector<double> power_w(gain);
    std::vector<double> nearest_m(rise_m.size());
    std::vector<double> farthest_m(rise_m.size());
    received_power_row(model, 321.0, 7.5, rise_m, power_w.data());
    beam_limits_row(model, 321.0, rise_m, nearest_m.data(), farthest_m.data());
    for (std::size_t i = 0; i < rise_m.size(); ++i) {
      CHECK(power_w[i] == power(model, rise_m[i], 7.5, gain[i]));
      const BeamLimits limits = beam_limits(model, 321.0, rise_m[i]);
      CHECK(nearest_m[i] == limits.nearest_m);
      CHECK(farthest_m[i] == limits.farthest_m);
    }
    std::vector<double> sinr(power_w);
    for (double& x : sinr) x *= 1e12;
    std::vector<double> efficiency(sinr.size());
    std::vector<double> db(sinr.size());
    spectral_efficiency_row(sinr, infinity, efficiency.data());
    decibel_row(sinr, db.data());
    for (std::size_t i = 0; i < sinr.size(); ++i) {
      CHECK(efficiency[i] == spectral_efficiency(sinr[i], infinity));
      CHECK(db[i] == decibel(sinr[i]));
    }
  }
}
