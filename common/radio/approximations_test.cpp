#include "common/radio/approximations.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/random.hpp"

using aloft::RandomStream;

TEST_CASE("the logarithm is within its stated error of the library's") {
  RandomStream stream(1, 0, "approximations");
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::exp(stream.uniform(-60.0, 60.0));
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    worst = std::fmax(worst, std::fabs(aloft::radio::natural_log(x) - exact) / std::fabs(exact));
  }
  for (const double x : {1.0 - 1e-9, 1.0 + 1e-9, 0.5, 2.0, std::sqrt(0.5), std::sqrt(2.0), 1e-300, 1e300}) {
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    worst = std::fmax(worst, std::fabs(aloft::radio::natural_log(x) - exact) / std::fabs(exact));
  }
  CHECK(worst < 1e-15);
  CHECK(aloft::radio::natural_log(1.0) == 0.0);
}

TEST_CASE("the power of two is within its stated error of the library's") {
  RandomStream stream(2, 0, "approximations");
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double y = stream.uniform(-1020.0, 1020.0);
    const auto exact = static_cast<double>(std::exp2(static_cast<long double>(y)));
    worst = std::fmax(worst, std::fabs(aloft::radio::exp2(y) - exact) / exact);
  }
  CHECK(worst < 1e-15);
  CHECK(aloft::radio::exp2(0.0) == 1.0);
  CHECK(aloft::radio::exp2(-40.0) == std::ldexp(1.0, -40));
}

TEST_CASE("the cosine of pi s is within its stated error of the library's") {
  const long double pi = std::acos(-1.0L);
  double worst = 0.0;
  for (int i = -10'000; i <= 10'000; ++i) {
    const double s = i / 10'000.0;
    const auto exact = static_cast<double>(std::cos(pi * s));
    worst = std::fmax(worst, std::fabs(aloft::radio::cos_pi(s) - exact));
  }
  CHECK(worst < 1e-15);
  CHECK(aloft::radio::cos_pi(0.5) == 0.0);
  // Near the zero: cos(pi (1/2 - 1e-9)) = sin(pi 1e-9).
  CHECK(aloft::radio::cos_pi(0.5 - 1e-9) == Approx(3.14159265358979e-9).epsilon(1e-7));
}

TEST_CASE("the arctangent is within its stated error of the library's") {
  RandomStream stream(3, 0, "approximations");
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double y = std::exp(stream.uniform(-12.0, 12.0));
    const double x = std::exp(stream.uniform(-12.0, 12.0));
    const auto exact = static_cast<double>(std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
    worst = std::fmax(worst, std::fabs(aloft::radio::arctangent(y, x) - exact));
  }
  CHECK(worst < 1e-15);
  CHECK(aloft::radio::arctangent(0.0, 3.0) == 0.0);
  CHECK(aloft::radio::arctangent(3.0, 0.0) == Approx(std::acos(0.0)).epsilon(1e-15));
  CHECK(aloft::radio::arctangent(0.0, 0.0) == 0.0);
}

TEST_CASE("the cosine of a root is within its stated error of the library's") {
  const long double pi = std::acos(-1.0L);
  double worst = 0.0;
  for (int i = 0; i <= 10'000; ++i) {
    const double s2 = i / 10'000.0;
    const auto exact = static_cast<double>(std::cos(pi * std::sqrt(static_cast<long double>(s2)) / 2));
    worst = std::fmax(worst, std::fabs(aloft::radio::cos_half_pi_root(s2) - exact));
  }
  CHECK(worst < 1e-15);
  CHECK(aloft::radio::cos_half_pi_root(0.0) == 1.0);
}
