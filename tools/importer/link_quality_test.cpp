#include "tools/importer/link_quality.hpp"

#include <array>
#include <catch2/catch.hpp>

using namespace aloft::importer;

TEST_CASE("throughput is Shannon's up to the highest modulation") {
  CHECK(throughput_kbps(0.0, {.bandwidth_mhz = 10.0}) == Approx(10'000.0));                 // log2(2)
  CHECK(throughput_kbps(10.0, {.bandwidth_mhz = 5.0}) == Approx(17'297.16).epsilon(1e-6));  // log2(11) = 3.459432
  CHECK(throughput_kbps(60.0, {.bandwidth_mhz = 10.0}) == Approx(74'063.0));                // 7.4063
  CHECK(throughput_kbps(30.0, {.bandwidth_mhz = 1.0, .spectral_efficiency_max = 0.0}) == Approx(9'967.226));
}

TEST_CASE("SINR follows from RSRQ and the load of the serving cell") {
  // All resource elements in use: RSRQ = 1 / (12 (1 + 1 / SINR)); 0 dB gives 1 / 24, which is -13.8021 dB.
  CHECK(sinr_from_rsrq_db(-13.8021, 1.0) == Approx(0.0).margin(1e-4));
  // Only the reference symbols, 2 of 12: 1 / (12 / 6 + 12 / SINR); 10 dB gives 1 / 3.2, which is -5.0515 dB.
  CHECK(sinr_from_rsrq_db(-5.0515, 1.0 / 6.0) == Approx(10.0).margin(1e-3));
  CHECK(sinr_from_rsrq_db(-3.0, 1.0) == 30.0);     // more than a fully loaded cell can have
  CHECK(sinr_from_rsrq_db(-10.792, 1.0) == 30.0);  // -10.7918 is its limit
}

TEST_CASE("noise and the serving cell") {
  CHECK(noise_dbm(10e6, 9.0) == Approx(-95.0));
  CHECK(noise_dbm(15e3, 9.0) == Approx(-123.2391).epsilon(1e-6));
  // 10^-7 mW over 10^-8 + 10^-8 + 10^-9: 10 / 2.1 = 4.761905, 6.7778 dB
  const Serving serving = strongest(std::array{-80.0, -70.0, -80.0}, -90.0);
  CHECK(serving.cell == 1);
  CHECK(serving.sinr_db == Approx(6.7778).margin(1e-4));
  CHECK(strongest(std::array{-70.0, -70.0}, -170.0).cell == 0);  // the first of equals
  CHECK(strongest(std::array{-70.0}, -90.0).sinr_db == Approx(20.0));
}
