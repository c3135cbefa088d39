#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "common/experiment/statistics.hpp"

namespace aloft::report {

/// 95 % percentile bootstrap interval of a statistic of paired observations, which is called with 10,000 lists of
/// `size` indices drawn with replacement. The same seed gives the same interval. Not known() if `size` is below 2.
[[nodiscard]] experiment::Interval resampled_ci95(
    std::size_t size, std::uint64_t seed, const std::function<double(std::span<const std::uint32_t>)>& statistic);

/// The same for an order statistic of one sample (median, interquartile mean), which is called with the resampled
/// values in ascending order. Not known() if all values are equal.
[[nodiscard]] experiment::Interval resampled_ci95(std::span<const double> sample, std::uint64_t seed,
                                                  const std::function<double(std::span<const double>)>& statistic);

/// Median of values in ascending order.
[[nodiscard]] double median_of_sorted(std::span<const double> sorted);

}  // namespace aloft::report
