#include "common/radio/gaussian_fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "common/base/widest_vectors.hpp"
#include "common/radio/approximations.hpp"

namespace aloft::radio {
namespace {

constexpr std::size_t lanes = 8;
static_assert(GaussianFields::waves % lanes == 0);

/// Bounds the turns over a city, so that their fraction keeps its digits: waves shorter than a micrometre are noise.
constexpr double most_turns_per_m = 1e6;

/// Adds amplitude x cos(2 pi turns) in lanes, so that the order of additions is that of the vectors.
[[gnu::always_inline]] inline void wave_loop(const double* x_turns_per_m, const double* y_turns_per_m, double x_m,
                                             double y_m, const double* amplitude, const double* phase, double* sum) {
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to a whole number in the lowest bits
  for (std::size_t first = 0; first < GaussianFields::waves; first += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = first + lane;
      const double turns = std::fma(x_turns_per_m[i], x_m, std::fma(y_turns_per_m[i], y_m, phase[i]));
      const double fraction = turns - ((turns + to_integer) - to_integer);
      sum[lane] = std::fma(amplitude[i], cos_pi(2.0 * fraction), sum[lane]);
    }
}

}  // namespace

GaussianFields::GaussianFields(std::uint64_t seed, std::uint32_t trial, std::string_view name, std::size_t stations,
                               double correlation_distance_m)
    : amplitude_(stations * waves), phase_(stations * waves) {
  RandomStream stream(seed, trial, name);
  std::vector<double> uniform(2 * waves);
  stream.uniforms(uniform);
  for (std::size_t i = 0; i < waves; ++i) {
    const double above = 1.0 - (static_cast<double>(i) + uniform[2 * i]) / waves;  // share of the power in longer k
    const double k_distances = std::sqrt(1.0 / (above * above) - 1.0);
    const double turns_per_m =
        std::min(k_distances / (2.0 * std::numbers::pi * correlation_distance_m), most_turns_per_m);
    const double half_turns = 2.0 * uniform[2 * i + 1] - 1.0;
    const double sine_of_size = cos_pi(0.5 - std::fabs(half_turns));
    x_turns_per_m_[i] = turns_per_m * cos_pi(half_turns);
    y_turns_per_m_[i] = turns_per_m * (half_turns < 0.0 ? -sine_of_size : sine_of_size);
  }
  for (std::size_t k = 0; k < stations; ++k) {
    stream.uniforms(uniform);
    for (std::size_t i = 0; i < waves; ++i) {
      amplitude_[k * waves + i] = std::sqrt(-2.0 / waves * natural_log(uniform[2 * i]));
      phase_[k * waves + i] = uniform[2 * i + 1];
    }
  }
}

double GaussianFields::at(world::Position place, std::uint32_t station) const noexcept {
  std::array<double, lanes> sum{};
  run_vectorised<wave_loop>(x_turns_per_m_.data(), y_turns_per_m_.data(), place.x_m, place.y_m,
                            amplitude_.data() + station * waves, phase_.data() + station * waves, sum.data());
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

double normal_cdf(double x) noexcept {
  const double size = std::fabs(x);
  if (size > 9.0) return x < 0.0 ? 0.0 : 1.0;  // 1e-19 away
  double term = size;
  double sum = size;
  for (double divisor = 3.0; term > 1e-17 * sum; divisor += 2.0) {
    term *= size * size / divisor;
    sum += term;
  }
  const double density = exp2(-0.5 / std::numbers::ln2 * size * size) / std::sqrt(2.0 * std::numbers::pi);
  return x < 0.0 ? 0.5 - density * sum : 0.5 + density * sum;
}

}  // namespace aloft::radio
