#include "common/radio/gaussian_fields.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace aloft;
using radio::GaussianFields;

namespace {

constexpr std::uint32_t trials = 100;
constexpr std::uint32_t stations = 100;

/// Mean product of the fields of equal stations at these places, over 10,000 stations.
double mean_product(double correlation_distance_m, world::Position a, world::Position b) {
  double sum = 0.0;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const GaussianFields fields(3, trial, "test", stations, correlation_distance_m);
    for (std::uint32_t k = 0; k < stations; ++k) sum += fields.at(a, k) * fields.at(b, k);
  }
  return sum / (trials * stations);
}

}  // namespace

TEST_CASE("the normal distribution function") {
  CHECK(radio::normal_cdf(0.0) == 0.5);
  CHECK(radio::normal_cdf(1.0) == Approx(0.841344746068542949).epsilon(1e-15));
  CHECK(radio::normal_cdf(1.95996398454005424) == Approx(0.975).epsilon(1e-15));
  CHECK(radio::normal_cdf(-3.0) == Approx(0.00134989803163009453).epsilon(1e-12));
  CHECK(1.0 - radio::normal_cdf(6.0) == Approx(9.86587645037698e-10).margin(1e-15));
  CHECK(radio::normal_cdf(-40.0) == 0.0);
  CHECK(radio::normal_cdf(40.0) == 1.0);
}

TEST_CASE("a Gaussian field is normally distributed: as a number of that distribution function it is uniform") {
  std::vector<double> uniform;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const GaussianFields fields(3, trial, "test", stations, 50.0);
    for (std::uint32_t k = 0; k < stations; ++k)
      uniform.push_back(radio::normal_cdf(fields.at({10.0 * trial, -7.0 * k}, k)));
  }
  std::ranges::sort(uniform);
  const auto size = static_cast<double>(uniform.size());
  double largest_gap = 0.0;  // Kolmogorov and Smirnov
  for (std::size_t i = 0; i < uniform.size(); ++i)
    largest_gap = std::max(largest_gap, std::fabs(uniform[i] - (static_cast<double>(i) + 0.5) / size));
  CHECK(largest_gap < 1.63 / std::sqrt(size));  // 99 %
}

TEST_CASE("a Gaussian field is correlated as exp(-distance / correlation distance), in every direction") {
  for (const double correlation_distance_m : {10.0, 50.0, 120.0})
    for (const double distance_m : {10.0, 50.0, 100.0}) {
      INFO(correlation_distance_m << " m, " << distance_m << " m apart");
      const double expected = std::exp(-distance_m / correlation_distance_m);
      CHECK(mean_product(correlation_distance_m, {400.0, -300.0}, {400.0 + distance_m, -300.0}) ==
            Approx(expected).margin(0.05));
      CHECK(mean_product(correlation_distance_m, {400.0, -300.0}, {400.0, -300.0 + distance_m}) ==
            Approx(expected).margin(0.05));
      CHECK(mean_product(correlation_distance_m, {0.0, 0.0}, {0.6 * distance_m, -0.8 * distance_m}) ==
            Approx(expected).margin(0.05));
    }
}

TEST_CASE("Gaussian fields of other stations, names, trials and seeds are other ones") {
  const GaussianFields fields(3, 0, "test", 1000, 50.0);
  const auto correlation = [&](auto other) {
    double sum = 0.0;
    for (std::uint32_t k = 0; k < 1000; ++k) sum += fields.at({1.0, 2.0}, k) * other(k);
    return sum / 1000.0;
  };
  const GaussianFields named(3, 0, "other", 1000, 50.0);
  const GaussianFields later(3, 1, "test", 1000, 50.0);
  const GaussianFields seeded(4, 0, "test", 1000, 50.0);
  for (const GaussianFields* other : {&named, &later, &seeded})
    CHECK(std::fabs(correlation([&](std::uint32_t k) { return other->at({1.0, 2.0}, k); })) < 0.1);
  CHECK(std::fabs(correlation([&](std::uint32_t k) { return fields.at({1.0, 2.0}, (k + 1) % 1000); })) < 0.1);
  CHECK(correlation([&](std::uint32_t k) { return fields.at({1.0, 2.0}, k); }) == Approx(1.0).margin(0.2));
}

TEST_CASE("a Gaussian field does not depend on the number of stations, nor on earlier questions") {
  const GaussianFields few(3, 5, "test", 2, 37.0);
  const GaussianFields many(3, 5, "test", 50, 37.0);
  const double first = many.at({123.0, 45.0}, 1);
  CHECK(many.at({0.0, 0.0}, 49) != first);
  CHECK(few.at({123.0, 45.0}, 1) == first);
  CHECK(many.at({123.0, 45.0}, 1) == first);
}
