#include "common/experiment/statistics.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/base/random.hpp"

namespace aloft::experiment {
namespace {

constexpr std::size_t resamples = 10'000;
// From here on the bootstrap of a mean and the normal interval agree to a fraction of a percent of their width.
constexpr std::size_t largest_resampled = 10'000;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double normal_quantile_975 = 1.959963984540054;

double quantile_of_sorted(std::span<const double> sorted, double p) {
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::vector<double> sorted_copy(std::span<const double> sample) {
  std::vector<double> sorted(sample.begin(), sample.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

Interval normal_ci95(std::span<const double> sample) {
  const double centre = mean(sample);
  double squares = 0.0;
  for (const double x : sample) squares += (x - centre) * (x - centre);
  const auto n = static_cast<double>(sample.size());
  // The variance of a resampled mean is squares / n^2.
  const double half_width = normal_quantile_975 * std::sqrt(squares) / n;
  return {centre - half_width, centre + half_width};
}

bool all_equal(std::span<const double> sample) {
  return std::all_of(sample.begin(), sample.end(), [&](double x) { return x == sample.front(); });
}

/// Means of `resamples` resamples: [sample][resample]. All samples share the draws, which are the expensive part.
std::vector<std::vector<double>> resampled_means(std::span<const std::span<const double>> samples, std::uint64_t seed) {
  const std::size_t size = samples.front().size();
  const std::size_t width = samples.size();
  std::vector<double> rows(size * width);  // [draw][sample], so that one draw adds up contiguous numbers
  for (std::size_t s = 0; s < width; ++s)
    for (std::size_t i = 0; i < size; ++i) rows[i * width + s] = samples[s][i];

  RandomStream random(seed, 0, "bootstrap");
  std::vector<std::vector<double>> means(width, std::vector<double>(resamples));
  std::vector<double> sums(width);
  for (std::size_t r = 0; r < resamples; ++r) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t i = 0; i < size; ++i) {
      const double* row = &rows[random.uniform_index(static_cast<std::uint32_t>(size)) * width];
      for (std::size_t s = 0; s < width; ++s) sums[s] += row[s];
    }
    for (std::size_t s = 0; s < width; ++s) means[s][r] = sums[s] / static_cast<double>(size);
  }
  return means;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> matches(std::span<const std::uint32_t> a,
                                                         std::span<const std::uint32_t> b) {
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (a[i] == b[k]) {
      result.emplace_back(i++, k++);
    } else if (a[i] < b[k]) {
      ++i;
    } else {
      ++k;
    }
  }
  return result;
}

double mean(std::span<const double> sample) {
  if (sample.empty()) return nan;
  double sum = 0.0;
  for (const double x : sample) sum += x;
  return sum / static_cast<double>(sample.size());
}

double quantile(std::span<const double> sample, double p) {
  if (sample.empty()) return nan;
  return quantile_of_sorted(sorted_copy(sample), p);
}

double interquartile_mean(std::span<const double> sample) {
  if (sample.empty()) return nan;
  const std::vector<double> sorted = sorted_copy(sample);
  const auto n = static_cast<double>(sorted.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    // The share of the i-th of n equal pieces of [0, n] that lies in the middle half.
    const double weight = std::min(static_cast<double>(i + 1), 0.75 * n) - std::max(static_cast<double>(i), 0.25 * n);
    if (weight > 0.0) sum += weight * sorted[i];
  }
  return sum / (0.5 * n);
}

std::vector<Interval> bootstrap_ci95(std::span<const std::span<const double>> samples, std::uint64_t seed) {
  if (samples.empty()) return {};
  for (const auto& sample : samples)
    if (sample.size() != samples.front().size()) throw std::logic_error("samples of different sizes");
  std::vector<Interval> intervals(samples.size(), {nan, nan});
  if (std::all_of(samples.begin(), samples.end(), all_equal)) return intervals;

  const bool normal = samples.front().size() > largest_resampled;
  std::vector<std::vector<double>> means;
  if (!normal) means = resampled_means(samples, seed);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (all_equal(samples[s])) continue;
    if (!normal) std::sort(means[s].begin(), means[s].end());
    intervals[s] = normal ? normal_ci95(samples[s])
                          : Interval{quantile_of_sorted(means[s], 0.025), quantile_of_sorted(means[s], 0.975)};
  }
  return intervals;
}

Interval bootstrap_ci95(std::span<const double> sample, std::uint64_t seed) {
  return bootstrap_ci95(std::span<const std::span<const double>>(&sample, 1), seed).front();
}

double probability_of_improvement(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) throw std::logic_error("pairs of samples of different sizes");
  if (a.empty()) return nan;
  double wins = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] > b[i]) wins += 1.0;
    if (a[i] == b[i]) wins += 0.5;
  }
  return wins / static_cast<double>(a.size());
}

}  // namespace aloft::experiment
