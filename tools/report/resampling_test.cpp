#include "tools/report/resampling.hpp"

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

using aloft::experiment::Interval;
using aloft::report::median_of_sorted;
using aloft::report::resampled_ci95;

TEST_CASE("The interval of a median is that of the exact bootstrap distribution", "[report]") {
  // The median of a resample of 11 distinct values is at most the k-th smallest with probability
  // P(Bin(11, k/11) >= 6): 0.0072 at k = 2, 0.0512 at k = 3. So the ends are the 3rd and, by symmetry, the 9th value.
  std::vector<double> sample(11);
  std::iota(sample.rbegin(), sample.rend(), 1.0);
  const Interval interval = resampled_ci95(std::span<const double>(sample), 1, median_of_sorted);
  CHECK(interval.low == 3.0);
  CHECK(interval.high == 9.0);
}

TEST_CASE("Resampled indices give the bootstrap interval of a mean", "[report]") {
  // 0..99: standard error sqrt((100^2 - 1) / 12 / 100) = 2.887, so the interval is 49.5 -+ 1.96 * 2.887 = 5.658.
  const auto mean_of_indices = [](std::span<const std::uint32_t> indices) {
    return std::accumulate(indices.begin(), indices.end(), 0.0) / static_cast<double>(indices.size());
  };
  const Interval interval = resampled_ci95(std::size_t{100}, 7, mean_of_indices);
  CHECK(interval.low == Approx(49.5 - 5.658).margin(0.25));
  CHECK(interval.high == Approx(49.5 + 5.658).margin(0.25));
  const Interval again = resampled_ci95(std::size_t{100}, 7, mean_of_indices);
  CHECK(again.low == interval.low);
  CHECK(resampled_ci95(std::size_t{100}, 8, mean_of_indices).low != interval.low);
}

TEST_CASE("A sample without spread has no interval", "[report]") {
  for (const std::size_t size : {0U, 1U, 20U}) {
    const std::vector<double> equal(size, 3.5);
    CHECK_FALSE(resampled_ci95(std::span<const double>(equal), 1, median_of_sorted).known());
  }
  CHECK_FALSE(resampled_ci95(std::size_t{1}, 1, [](std::span<const std::uint32_t>) { return 1.0; }).known());
  CHECK(median_of_sorted(std::vector<double>{1.0, 2.0, 4.0, 9.0}) == 3.0);
}
