#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/world/world.hpp"

namespace aloft::radio {

/// Random fields over the ground, one per base station, independent of each other: normally distributed with mean 0 and
/// variance 1, correlated as exp(-distance / correlation distance). Values are pure functions of seed, trial, name,
/// station and place.
///
/// A field is a sum of plane waves (Cai and Giannakis 2003, A Two-Dimensional Channel Simulation Model for Shadowing
/// Processes), whose wave vectors follow the power spectrum of that correlation, (1 + (k D)^2)^(-3/2), by inversion in
/// equal parts of probability. All stations of a trial share the wave vectors; their amplitudes, which are Rayleigh
/// distributed, and phases are their own. Distribution and correlation are exact over trials; within one, the
/// correlation deviates by about 1 / sqrt(waves).
class GaussianFields {
 public:
  static constexpr std::size_t waves = 64;

  GaussianFields(std::uint64_t seed, std::uint32_t trial, std::string_view name, std::size_t stations,
                 double correlation_distance_m);

  [[nodiscard]] double at(world::Position place, std::uint32_t station) const noexcept;

 private:
  std::array<double, waves> x_turns_per_m_{};  // the wave vectors
  std::array<double, waves> y_turns_per_m_{};
  std::vector<double> amplitude_;  // [station][wave]
  std::vector<double> phase_;      // [station][wave], turns
};

/// The standard normal distribution function, absolute error < 1e-15: 1/2 + density(x) (x + x^3/3 + x^5/(3 5) + ...)
/// (Marsaglia 2004, Evaluating the Normal Distribution). The same bits on every machine.
[[nodiscard]] double normal_cdf(double x) noexcept;

}  // namespace aloft::radio
