#include "common/radio/fading.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "common/radio/generated_world.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

radio::Fading fading_of(const json& given) {
  const radio::RadioModel model(radio::resolve_generated_world(given, "world"));
  return {model, 5, 7};
}

std::vector<double> row(radio::Fading& fading, std::uint32_t point, std::uint32_t c, std::uint32_t k,
                        std::uint32_t blocks) {
  std::vector<std::uint32_t> all(blocks);
  std::iota(all.begin(), all.end(), 0U);
  fading.want(point, c, k, all);
  const std::span<const double> values = fading.take(point);
  return {values.begin(), values.end()};
}

}  // namespace

TEST_CASE("independent fading is exponential with mean 1, and different for every link and height") {
  radio::Fading fading = fading_of(json::object());
  double sum = 0.0;
  double squares = 0.0;
  double adjacent = 0.0;
  int above_one = 0;
  int count = 0;
  for (std::uint32_t point = 0; point < 20; ++point) {
    for (std::uint32_t k = 0; k < 20; ++k) {
      const std::vector<double> f = row(fading, point, 3, k, 50);
      for (std::size_t i = 0; i < f.size(); ++i, ++count) {
        sum += f[i];
        squares += f[i] * f[i];
        above_one += f[i] > 1.0 ? 1 : 0;
        if (i > 0) adjacent += (f[i] - 1.0) * (f[i - 1] - 1.0);
      }
    }
  }
  const double n = count;  // 80,000: standard error of the mean 0.0035
  CHECK(sum / n == Approx(1.0).margin(0.015));
  CHECK(squares / n == Approx(2.0).margin(0.07));
  CHECK(above_one / n == Approx(std::exp(-1.0)).margin(0.008));
  CHECK(adjacent / n == Approx(0.0).margin(0.02));
}

TEST_CASE("fading does not depend on which heights were requested, or when") {
  for (const double correlation : {0.0, 0.9, 1.0}) {
    for (const char* kind : {"independent", "correlated", "none"}) {
      radio::Fading fading = fading_of({{"fading", kind}, {"fading_correlation", correlation}});
      const std::vector<double> all = row(fading, 4, 1, 2, 51);
      const std::vector<double> other = row(fading, 4, 2, 1, 13);
      row(fading, 9, 2, 1, 3);
      fading.want(4, 1, 2, std::vector<std::uint32_t>{7, 31});
      fading.want(4, 2, 1, std::vector<std::uint32_t>{12});
      const std::span<const double> some = fading.take(4);
      REQUIRE(some.size() == 12);
      for (std::size_t i = 0; i < 4; ++i) {
        CHECK(some[i] == all[28 + i]);
        CHECK(some[4 + i] == all[124 + i]);
        CHECK(some[8 + i] == other[48 + i]);
      }
    }
  }
}

TEST_CASE("correlated fading has mean 1 and the stated correlation between adjacent heights") {
  const double correlation = 0.8;
  radio::Fading fading = fading_of({{"fading", "correlated"}, {"fading_correlation", correlation}});
  double sum = 0.0;
  double squares = 0.0;
  double adjacent = 0.0;
  double n = 0.0;
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const std::vector<double> f = row(fading, 0, 0, k, 10);
    for (std::size_t i = 1; i < f.size(); ++i, n += 1.0) {
      sum += f[i];
      squares += f[i] * f[i];
      adjacent += (f[i] - 1.0) * (f[i - 1] - 1.0);
    }
  }
  CHECK(sum / n == Approx(1.0).margin(0.03));
  CHECK(squares / n == Approx(2.0).margin(0.15));
  // Powers of complex Gaussian amplitudes correlate with the square of the amplitudes' correlation.
  CHECK(adjacent / n == Approx(correlation * correlation).margin(0.06));
}

TEST_CASE("the correlation is per metre, and 1 means constant over height") {
  radio::Fading constant = fading_of({{"fading", "correlated"}});
  const std::vector<double> f = row(constant, 0, 0, 1, 5);
  for (const double x : f) CHECK(x == f[0]);
  CHECK(row(constant, 1, 0, 1, 1)[0] != f[0]);
  const radio::RadioModel coarse(radio::resolve_generated_world(
      {{"fading", "correlated"}, {"fading_correlation", 0.9}, {"height_resolution_m", 10}}, "world"));
  CHECK(coarse.fading_correlation == Approx(std::pow(0.9, 10)).epsilon(1e-12));
}
