#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

/// Elementary functions made of fused multiply-adds, additions, multiplications and divisions only, so that they give
/// the same bits on every machine and loops over them vectorise. They are truncated series, whose error bounds follow
/// from the first term left out; rounding adds a few units in the last place. The tests check the stated bounds.
namespace aloft::radio {

/// Natural logarithm; x positive and normal. Relative error < 1e-15.
/// x = 2^k m with m in [sqrt(1/2), sqrt(2)); ln m = 2 atanh(s) = 2 (s + s^3/3 + ... + s^19/19), s = (m-1)/(m+1), where
/// |s| < 0.1716 makes the first term left out smaller than 1e-17 of the sum.
[[gnu::always_inline]] inline double natural_log(double x) noexcept {
  constexpr std::uint64_t one_bits = 0x3FF0000000000000U;
  constexpr std::uint64_t sqrt_half_bits = 0x3FE6A09E667F3BCDU;
  constexpr std::uint64_t mantissa_mask = 0x000FFFFFFFFFFFFFU;
  constexpr std::uint64_t two_to_52_bits = 0x4330000000000000U;
  const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) + (one_bits - sqrt_half_bits);
  // An integer below 2^52 or'ed into the bits of 2^52 is 2^52 + the integer.
  const double k = std::bit_cast<double>((shifted >> 52U) | two_to_52_bits) - (0x1p52 + 1023.0);
  const double m = std::bit_cast<double>((shifted & mantissa_mask) + sqrt_half_bits);
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double series = 1.0 / 19.0;
  series = std::fma(series, z, 1.0 / 17.0);
  series = std::fma(series, z, 1.0 / 15.0);
  series = std::fma(series, z, 1.0 / 13.0);
  series = std::fma(series, z, 1.0 / 11.0);
  series = std::fma(series, z, 1.0 / 9.0);
  series = std::fma(series, z, 1.0 / 7.0);
  series = std::fma(series, z, 1.0 / 5.0);
  series = std::fma(series, z, 1.0 / 3.0);
  return std::fma(k, std::numbers::ln2, std::fma(2.0 * s * z, series, 2.0 * s));
}

/// 2^y for |y| < 1022. Relative error < 1e-15.
/// y = n + f with |f| <= 1/2; 2^f is the Taylor series of e^(f ln 2) up to the 13th power.
[[gnu::always_inline]] inline double exp2(double y) noexcept {
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to a whole number in the lowest bits
  const double shifted = y + to_integer;
  const double x = (y - (shifted - to_integer)) * std::numbers::ln2;
  double series = 1.0 / 6227020800.0;
  series = std::fma(series, x, 1.0 / 479001600.0);
  series = std::fma(series, x, 1.0 / 39916800.0);
  series = std::fma(series, x, 1.0 / 3628800.0);
  series = std::fma(series, x, 1.0 / 362880.0);
  series = std::fma(series, x, 1.0 / 40320.0);
  series = std::fma(series, x, 1.0 / 5040.0);
  series = std::fma(series, x, 1.0 / 720.0);
  series = std::fma(series, x, 1.0 / 120.0);
  series = std::fma(series, x, 1.0 / 24.0);
  series = std::fma(series, x, 1.0 / 6.0);
  series = std::fma(series, x, 1.0 / 2.0);
  series = std::fma(series, x, 1.0);
  series = std::fma(series, x, 1.0);
  return series * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U);
}

/// 10^x for |x| < 307.
[[gnu::always_inline]] inline double power_of_ten(double x) noexcept {
  return exp2(x * (std::numbers::ln10 / std::numbers::ln2));
}

/// cos(pi s) for |s| <= 1. Absolute error < 1e-15, relative error near the zeros at +-1/2 too.
/// cos(pi s) = sin(pi t) with t = 1/2 - |s|; Taylor series up to (pi t)^21.
[[gnu::always_inline]] inline double cos_pi(double s) noexcept {
  const double x = std::numbers::pi * (0.5 - (s < 0.0 ? -s : s));
  const double z = -(x * x);
  double series = 1.0 / 51090942171709440000.0;
  series = std::fma(series, z, 1.0 / 121645100408832000.0);
  series = std::fma(series, z, 1.0 / 355687428096000.0);
  series = std::fma(series, z, 1.0 / 1307674368000.0);
  series = std::fma(series, z, 1.0 / 6227020800.0);
  series = std::fma(series, z, 1.0 / 39916800.0);
  series = std::fma(series, z, 1.0 / 362880.0);
  series = std::fma(series, z, 1.0 / 5040.0);
  series = std::fma(series, z, 1.0 / 120.0);
  series = std::fma(series, z, 1.0 / 6.0);
  return std::fma(x * z, series, x);
}

/// cos(pi sqrt(s2) / 2) for 0 <= s2 <= 1. Absolute error < 1e-15. Taylor series up to x^22 with x = pi sqrt(s2) / 2.
[[gnu::always_inline]] inline double cos_half_pi_root(double s2) noexcept {
  const double z = (-0.25 * std::numbers::pi * std::numbers::pi) * s2;
  double series = 1.0 / 1124000727777607680000.0;
  series = std::fma(series, z, 1.0 / 2432902008176640000.0);
  series = std::fma(series, z, 1.0 / 6402373705728000.0);
  series = std::fma(series, z, 1.0 / 20922789888000.0);
  series = std::fma(series, z, 1.0 / 87178291200.0);
  series = std::fma(series, z, 1.0 / 479001600.0);
  series = std::fma(series, z, 1.0 / 3628800.0);
  series = std::fma(series, z, 1.0 / 40320.0);
  series = std::fma(series, z, 1.0 / 720.0);
  series = std::fma(series, z, 1.0 / 24.0);
  series = std::fma(series, z, 1.0 / 2.0);
  return std::fma(z, series, 1.0);
}

/// The angle in radians, 0 to pi/2, whose tangent is y / x; 0 where both are 0. x, y >= 0. Absolute error < 1e-15.
/// Two halvings, tan(a/2) = t / (1 + sqrt(1 + t^2)), bring it below pi/16, where the Taylor series up to t^23 suffices.
[[gnu::always_inline]] inline double arctangent(double y, double x) noexcept {
  const double larger = y > x ? y : x;
  const double smaller = y > x ? x : y;
  const double tangent = smaller / (larger > 0.0 ? larger : 1.0);
  const double half = tangent / (1.0 + std::sqrt(std::fma(tangent, tangent, 1.0)));
  const double t = half / (1.0 + std::sqrt(std::fma(half, half, 1.0)));
  const double z = -(t * t);
  double series = 1.0 / 23.0;
  series = std::fma(series, z, 1.0 / 21.0);
  series = std::fma(series, z, 1.0 / 19.0);
  series = std::fma(series, z, 1.0 / 17.0);
  series = std::fma(series, z, 1.0 / 15.0);
  series = std::fma(series, z, 1.0 / 13.0);
  series = std::fma(series, z, 1.0 / 11.0);
  series = std::fma(series, z, 1.0 / 9.0);
  series = std::fma(series, z, 1.0 / 7.0);
  series = std::fma(series, z, 1.0 / 5.0);
  series = std::fma(series, z, 1.0 / 3.0);
  const double angle = 4.0 * std::fma(t * z, series, t);
  return y > x ? 0.5 * std::numbers::pi - angle : angle;
}

}  // namespace aloft::radio
