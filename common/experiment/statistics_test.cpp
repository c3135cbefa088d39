#include "common/experiment/statistics.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace aloft::experiment;
using Sample = std::vector<double>;

TEST_CASE("all statistics of an empty sample are NaN") {
  CHECK(mean(Sample{1, 2, 6}) == 3.0);
  CHECK(std::isnan(mean(Sample{})));
  CHECK(std::isnan(quantile(Sample{}, 0.5)));
  CHECK(std::isnan(interquartile_mean(Sample{})));
  CHECK_FALSE(bootstrap_ci95(Sample{}, 1).known());
  CHECK(std::isnan(probability_of_improvement(Sample{}, Sample{})));
}

TEST_CASE("quantiles are those of R's quantile(x, p), type 7") {
  const Sample digits_of_pi{3, 1, 4, 1, 5, 9, 2, 6};    // sorted: 1 1 2 3 4 5 6 9
  CHECK(quantile(digits_of_pi, 0.25) == Approx(1.75));  // position 0.25 * 7 = 1.75, between 1 and 2
  CHECK(quantile(digits_of_pi, 0.5) == Approx(3.5));
  CHECK(quantile(digits_of_pi, 0.75) == Approx(5.25));
  CHECK(quantile(digits_of_pi, 0.0) == 1.0);
  CHECK(quantile(digits_of_pi, 1.0) == 9.0);
  CHECK(quantile(Sample{7.0}, 0.975) == 7.0);
}

TEST_CASE("the interquartile mean gives the edges of the middle half fractional weights") {
  // Both from the article "Interquartile mean" in Wikipedia; the last by hand.
  CHECK(interquartile_mean(Sample{5, 8, 4, 38, 8, 6, 9, 7, 7, 3, 1, 6}) == Approx(6.5));
  CHECK(interquartile_mean(Sample{1, 3, 5, 7, 9, 11, 13, 15, 17}) == Approx(9.0));
  // n = 6: weights 0, 0.5, 1, 1, 0.5, 0: (0.5 * 1 + 2 + 3 + 0.5 * 10) / 3
  CHECK(interquartile_mean(Sample{50, 0, 1, 10, 2, 3}) == Approx(3.5));
}

TEST_CASE("the bootstrap interval agrees with the exact distribution of all resamples") {
  // All 6^6 resamples of six numbers, counted out.
  const Sample sample{0.0, 1.0, 3.0, 7.0, 12.0, 30.0};
  Sample means;
  for (int code = 0; code < 46656; ++code) {
    double sum = 0.0;
    for (int rest = code, i = 0; i < 6; ++i, rest /= 6) sum += sample[static_cast<std::size_t>(rest % 6)];
    means.push_back(sum / 6.0);
  }
  const Interval interval = bootstrap_ci95(sample, 7);
  CHECK(interval.low == Approx(quantile(means, 0.025)).margin(0.2));
  CHECK(interval.high == Approx(quantile(means, 0.975)).margin(0.4));
}

TEST_CASE("the bootstrap interval of a binary sample ends at binomial quantiles") {
  Sample sample(20, 0.0);
  std::fill_n(sample.begin(), 10, 1.0);
  // P(Binomial(20, 1/2) <= 5) = 0.0207 < 0.025 < P(... <= 6) = 0.0577
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Interval interval = bootstrap_ci95(sample, seed);
    CHECK(interval.low == Approx(0.3));
    CHECK(interval.high == Approx(0.7));
  }
}

TEST_CASE("the normal interval of large samples continues the resampled one") {
  Sample sample;
  for (int i = 0; i < 10'000; ++i) sample.push_back(std::fmod(i * 0.6180339887498949, 1.0));
  const Interval resampled = bootstrap_ci95(sample, 1);
  sample.push_back(0.5);
  const Interval normal = bootstrap_ci95(sample, 1);
  const double width = 2 * 1.96 * std::sqrt(1.0 / 12.0) / 100.0;  // uniform numbers
  CHECK(normal.high - normal.low == Approx(width).epsilon(0.01));
  CHECK(resampled.high - resampled.low == Approx(width).epsilon(0.05));
  CHECK(normal.low + normal.high == Approx(1.0).margin(1e-3));
}

TEST_CASE("there is no interval where nothing varies, alone and beside others") {
  CHECK_FALSE(bootstrap_ci95(Sample{7}, 1).known());
  CHECK_FALSE(bootstrap_ci95(Sample(20'000, 7.0), 1).known());
  const Sample same{3, 3, 3};
  const Sample other{1, 5, 2};
  const std::vector<std::span<const double>> both{same, other};
  const auto together = bootstrap_ci95(both, 11);
  CHECK_FALSE(together[0].known());
  CHECK(together[1].low == bootstrap_ci95(other, 11).low);
}

TEST_CASE("equal samples and seeds give equal intervals, alone and together") {
  const Sample a{1, 5, 2, 8, 3};
  const Sample b{2, 2, 4, 4, 9};
  const std::vector<std::span<const double>> both{a, b};
  const auto together = bootstrap_ci95(both, 11);
  REQUIRE(together.size() == 2);
  CHECK(together[0].low == bootstrap_ci95(a, 11).low);
  CHECK(together[1].high == bootstrap_ci95(b, 11).high);
  Sample many;
  for (int i = 0; i < 100; ++i) many.push_back(std::sqrt(i));
  CHECK(bootstrap_ci95(many, 11).low != bootstrap_ci95(many, 12).low);
  CHECK(bootstrap_ci95(std::span<const std::span<const double>>{}, 1).empty());
}

TEST_CASE("the probability of improvement counts ties half") {
  CHECK(probability_of_improvement(Sample{1, 2, 3, 4}, Sample{0, 2, 5, 1}) == Approx(2.5 / 4));
}
