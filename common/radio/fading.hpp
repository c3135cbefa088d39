#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/limits.hpp"
#include "common/base/random.hpp"
#include "common/radio/radio_model.hpp"

namespace aloft::radio {

/// Rayleigh fading: power factors f ~ Exp(1) for every (route point, candidate c, transmitter k, height) of a trial. f
/// is a pure function of these, so the order of calls does not matter.
///
/// independent: all f are independent, as in the published simulator. correlated: the complex amplitude is a
/// first-order autoregression over height with this correlation between adjacent heights of the table (1: constant over
/// height). none: f = 1.
class Fading {
 public:
  static constexpr std::uint32_t lanes = 4;  ///< heights that share one block of random words
  static constexpr std::uint32_t max_stations = limits::base_stations;  ///< c and k share a counter word
  static_assert(std::uint64_t{max_stations} * max_stations == std::uint64_t{1}
                                                                  << 32U);  // the counter word is c * max_stations + k

  Fading(const RadioModel& model, std::uint64_t seed, std::uint32_t trial)
      : kind_(model.fading), correlation_(model.fading_correlation), stream_(seed, trial, "fading") {}

  /// Requests f at heights 4 b .. 4 b + 3 for each b of `blocks` (ascending).
  void want(std::uint32_t point, std::uint32_t c, std::uint32_t k, std::span<const std::uint32_t> blocks);
  /// Four values per block requested since the last call, in the order of requests, which must all have been for this
  /// point. Valid until the next request.
  [[nodiscard]] std::span<const double> take(std::uint32_t point);

  /// The counter of candidate c and transmitter k.
  [[nodiscard]] static constexpr std::uint32_t pair(std::uint32_t c, std::uint32_t k) noexcept {
    return c * max_stations + k;
  }
  /// The same f at one height for each of these pairs. Valid until the next request.
  [[nodiscard]] std::span<const double> at_height(std::uint32_t point, std::span<const std::uint32_t> pairs,
                                                  std::uint32_t height);

 private:
  void correlated(std::uint32_t point, std::uint32_t pair, std::span<const std::uint32_t> blocks);

  FadingKind kind_;
  double correlation_;
  RandomStream stream_;
  // The requested blocks: counters if the fading is independent, else values.
  std::vector<std::uint32_t> pairs_;
  std::vector<std::uint32_t> blocks_;
  std::vector<double> wanted_;
  std::vector<std::uint32_t> words_;
  std::vector<double> values_;
};

}  // namespace aloft::radio
