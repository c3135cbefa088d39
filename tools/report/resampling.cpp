#include "tools/report/resampling.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "common/base/random.hpp"

namespace aloft::report {
namespace {

constexpr std::size_t resamples = 10'000;

experiment::Interval percentile_interval(const std::vector<double>& values) {
  return {experiment::quantile(values, 0.025), experiment::quantile(values, 0.975)};
}

experiment::Interval unknown() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {nan, nan};
}

}  // namespace

experiment::Interval resampled_ci95(std::size_t size, std::uint64_t seed,
                                    const std::function<double(std::span<const std::uint32_t>)>& statistic) {
  if (size < 2) return unknown();
  RandomStream random(seed, 0, "report.resampling");
  std::vector<std::uint32_t> indices(size);
  std::vector<double> values(resamples);
  for (double& value : values) {
    for (std::uint32_t& index : indices) index = random.uniform_index(static_cast<std::uint32_t>(size));
    value = statistic(indices);
  }
  return percentile_interval(values);
}

experiment::Interval resampled_ci95(std::span<const double> sample, std::uint64_t seed,
                                    const std::function<double(std::span<const double>)>& statistic) {
  std::vector<double> sorted(sample.begin(), sample.end());
  std::ranges::sort(sorted);
  if (sorted.empty() || sorted.front() == sorted.back()) return unknown();
  std::vector<std::uint32_t> counts(sorted.size());
  std::vector<double> resampled(sorted.size());
  // Counting how often each value was drawn keeps a resample in order without sorting it.
  return resampled_ci95(sorted.size(), seed, [&](std::span<const std::uint32_t> indices) {
    std::ranges::fill(counts, 0U);
    for (const std::uint32_t index : indices) ++counts[index];
    auto next = resampled.begin();
    for (std::size_t i = 0; i < sorted.size(); ++i) next = std::fill_n(next, counts[i], sorted[i]);
    return statistic(resampled);
  });
}

double median_of_sorted(std::span<const double> sorted) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

}  // namespace aloft::report
