#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace aloft::bus {

/// Upper bounds, in seconds, of the buckets in which a worker counts the times from report to command; one more bucket
/// holds longer times. WorkerStatus has room for exactly these.
inline constexpr std::array answer_bounds_s{20e-6, 50e-6, 100e-6, 200e-6, 500e-6, 1e-3,   2e-3, 5e-3,
                                            10e-3, 20e-3, 50e-3,  100e-3, 200e-3, 500e-3, 1.0};
using AnswerCounts = std::array<std::uint64_t, answer_bounds_s.size() + 1>;

/// The bucket of a time; a bound belongs to the bucket that it ends.
[[nodiscard]] inline std::size_t answer_bucket(double seconds) noexcept {
  return static_cast<std::size_t>(std::lower_bound(answer_bounds_s.begin(), answer_bounds_s.end(), seconds) -
                                  answer_bounds_s.begin());
}

/// A time within which at least `share` (0 to 1) of all answers came: the upper bound of a bucket, infinity for the
/// last one. NaN without answers.
[[nodiscard]] inline double answered_within_s(const AnswerCounts& counts, double share) noexcept {
  double all = 0.0;
  for (const std::uint64_t count : counts) all += static_cast<double>(count);
  if (all == 0.0) return std::nan("");
  double below = 0.0;
  for (std::size_t i = 0; i < answer_bounds_s.size(); ++i) {
    below += static_cast<double>(counts[i]);
    if (below >= share * all) return answer_bounds_s[i];
  }
  return INFINITY;
}

}  // namespace aloft::bus
