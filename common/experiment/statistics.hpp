#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace aloft::experiment {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  /// False (NaN) for a sample of one value or of equal ones, which tells nothing about the spread.
  [[nodiscard]] bool known() const noexcept { return std::isfinite(low) && std::isfinite(high); }
};

/// Where two ascending lists have the same element: pairs of indices, ascending.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> matches(std::span<const std::uint32_t> a,
                                                                       std::span<const std::uint32_t> b);

/// Arithmetic mean, summed in order. NaN for an empty sample, as all functions below give.
[[nodiscard]] double mean(std::span<const double> sample);
/// Linear interpolation between order statistics (type 7 of Hyndman and Fan 1996, R's default); p in [0, 1].
[[nodiscard]] double quantile(std::span<const double> sample, double p);
/// Mean of the middle half: the lowest and highest 25 % are left out, with fractional weights (recommended by Agarwal
/// et al., Deep Reinforcement Learning at the Edge of the Statistical Precipice, 2021).
[[nodiscard]] double interquartile_mean(std::span<const double> sample);

/// 95 % percentile bootstrap interval (Efron 1979) of the mean: 10,000 resamples, seeded, so equal samples give equal
/// intervals. Samples of more than 10,000 get the normal interval that the bootstrap converges to. Not known() where
/// there is nothing to resample: one trial, or equal values, e.g. of a deterministic agent over a measured flight.
[[nodiscard]] Interval bootstrap_ci95(std::span<const double> sample, std::uint64_t seed);
/// The same for several samples of one size at little more than the cost of one: they share the draws.
[[nodiscard]] std::vector<Interval> bootstrap_ci95(std::span<const std::span<const double>> samples,
                                                   std::uint64_t seed);

/// Share of pairs (a_i, b_i) on the same worlds with a_i > b_i; ties count half.
[[nodiscard]] double probability_of_improvement(std::span<const double> a, std::span<const double> b);

}  // namespace aloft::experiment
