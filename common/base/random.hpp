#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace aloft {

/// The only source of randomness: Philox4x32-10 (Salmon et al., Parallel Random Numbers: As Easy as 1, 2, 3, 2011), a
/// pure function of (seed, trial, stream name, counter).
/// Equal keys give equal numbers on every machine; streams with different names are independent. No distribution of the
/// standard library is used, because they differ between libraries.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint32_t trial, std::string_view name) noexcept;

  /// Random access: the four words at counter (a, b, c). Independent of the sequential draws below, which own the
  /// counters with a = 0xFFFFFFFF.
  [[nodiscard]] std::array<std::uint32_t, 4> block(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept;

  /// The words at counters (a, b[i], c[i]), one block after the other: 4 b.size() words.
  void blocks(std::uint32_t a, std::span<const std::uint32_t> b, std::span<const std::uint32_t> c,
              std::uint32_t* words) const noexcept;

  std::uint32_t next_u32() noexcept;
  /// Uniform in (0, 1), 53 bits, never 0 or 1.
  double uniform() noexcept;
  /// As many uniform() as there are places, sooner.
  void uniforms(std::span<double> values) noexcept;
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// Uniform in {0, ..., n - 1} without bias; n >= 1.
  std::uint32_t uniform_index(std::uint32_t n) noexcept;
  /// Normal with mean 0, standard deviation 1 (Box-Muller, one value per two uniforms).
  double normal() noexcept;
  /// Poisson with this mean: products of uniforms (Knuth), in pieces of mean at most 500. The cost grows with the mean.
  std::uint32_t poisson(double mean) noexcept;

  /// The position of the sequential draws, so that a checkpoint can resume them.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  void seek(std::uint64_t position) noexcept { position_ = position; }

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint32_t trial_;
  std::uint64_t position_ = 0;  // in words
  std::uint64_t buffered_block_ = ~std::uint64_t{0};
  std::array<std::uint32_t, 4> buffer_{};
};

/// Uniform in (0, 1) from one word; 32 bits.
[[nodiscard]] constexpr double unit_interval(std::uint32_t word) noexcept {
  return (word + 0.5) * 0x1p-32;
}

/// Mixes a 64-bit value so that every input bit changes half of the output bits (SplitMix64 finaliser).
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// FNV-1a, 64 bits: names to numbers.
[[nodiscard]] constexpr std::uint64_t name_hash(std::string_view name) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

}  // namespace aloft
