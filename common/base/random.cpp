#include "common/base/random.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "common/base/widest_vectors.hpp"

namespace aloft {
namespace {

constexpr std::uint32_t sequential_marker = 0xFFFFFFFFU;
constexpr double largest_poisson_piece = 500.0;  // exp(-500) is still a normal double

struct PhiloxKey {
  std::uint32_t low;
  std::uint32_t high;
};

[[gnu::always_inline]] inline void philox_loop(PhiloxKey key, std::uint32_t trial, std::uint32_t a,
                                               const std::uint32_t* b, const std::uint32_t* c, std::size_t size,
                                               std::uint32_t* words) {
  for (std::size_t i = 0; i < size; ++i) {
    const r123::Philox4x32 philox;
    const auto four = philox({{a, b[i], c[i], trial}}, {{key.low, key.high}});
    for (std::size_t w = 0; w < 4; ++w) words[4 * i + w] = four[w];
  }
}

/// Uniform in (0, 1) from two words, the high one first.
[[gnu::always_inline]] inline double uniform_of(std::uint64_t high, std::uint64_t low) noexcept {
  return (static_cast<double>(((high << 32U) | low) >> 12U) + 0.5) * 0x1p-52;
}

[[gnu::always_inline]] inline void uniform_loop(const std::uint32_t* words, std::size_t size, double* values) {
  for (std::size_t i = 0; i < size; ++i) values[i] = uniform_of(words[2 * i], words[2 * i + 1]);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint32_t trial, std::string_view name) noexcept : trial_(trial) {
  const std::uint64_t key = mix64(seed + 0x9e3779b97f4a7c15U) ^ mix64(name_hash(name));
  key_ = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32U)};
}

std::array<std::uint32_t, 4> RandomStream::block(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
  const r123::Philox4x32 philox;
  const auto words = philox({{a, b, c, trial_}}, {{key_[0], key_[1]}});
  return {words[0], words[1], words[2], words[3]};
}

void RandomStream::blocks(std::uint32_t a, std::span<const std::uint32_t> b, std::span<const std::uint32_t> c,
                          std::uint32_t* words) const noexcept {
  run_vectorised<philox_loop>(PhiloxKey{key_[0], key_[1]}, trial_, a, b.data(), c.data(), c.size(), words);
}

std::uint32_t RandomStream::next_u32() noexcept {
  const std::uint64_t wanted = position_ / 4;
  if (wanted != buffered_block_) {
    buffer_ = block(sequential_marker, static_cast<std::uint32_t>(wanted), static_cast<std::uint32_t>(wanted >> 32U));
    buffered_block_ = wanted;
  }
  return buffer_[position_++ % 4];
}

double RandomStream::uniform() noexcept {
  const std::uint64_t high = next_u32();
  const std::uint64_t low = next_u32();
  return uniform_of(high, low);
}

void RandomStream::uniforms(std::span<double> values) noexcept {
  constexpr std::size_t most = 64;  // blocks at once
  std::array<std::uint32_t, most> low;
  std::array<std::uint32_t, most> high;
  std::array<std::uint32_t, 4 * most> words;
  for (; position_ % 4 != 0 && !values.empty(); values = values.subspan(1)) values.front() = uniform();
  while (values.size() >= 2) {
    const std::size_t count = std::min(most, values.size() / 2);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t wanted = position_ / 4 + i;
      low[i] = static_cast<std::uint32_t>(wanted);
      high[i] = static_cast<std::uint32_t>(wanted >> 32U);
    }
    blocks(sequential_marker, std::span(low).first(count), std::span(high).first(count), words.data());
    run_vectorised<uniform_loop>(words.data(), 2 * count, values.data());
    position_ += 4 * count;
    values = values.subspan(2 * count);
  }
  for (double& value : values) value = uniform();
}

std::uint32_t RandomStream::uniform_index(std::uint32_t n) noexcept {
  // Lemire's method (Fast Random Integer Generation in an Interval, 2019): unbiased, and hardly ever draws twice.
  std::uint64_t product = std::uint64_t{next_u32()} * n;
  if (static_cast<std::uint32_t>(product) < n) {
    const std::uint32_t threshold = (0U - n) % n;
    while (static_cast<std::uint32_t>(product) < threshold) product = std::uint64_t{next_u32()} * n;
  }
  return static_cast<std::uint32_t>(product >> 32U);
}

double RandomStream::normal() noexcept {
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

std::uint32_t RandomStream::poisson(double mean) noexcept {
  std::uint32_t count = 0;
  for (double left = mean; left > 0.0; left -= largest_poisson_piece) {
    const double limit = std::exp(-std::fmin(left, largest_poisson_piece));
    for (double product = uniform(); product > limit; product *= uniform()) ++count;
  }
  return count;
}

}  // namespace aloft
