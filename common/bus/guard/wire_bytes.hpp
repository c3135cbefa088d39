#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aloft::bus::guard {

/// Reads numbers from a part of a datagram. A read beyond the end gives 0, and failed() is true from then on: so a row
/// of reads needs one check.
class WireBytes {
 public:
  WireBytes(std::span<const unsigned char> bytes, bool little_endian) : bytes_(bytes), little_endian_(little_endian) {}

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }
  [[nodiscard]] bool little_endian() const noexcept { return little_endian_; }

  std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(number(1, true)); }
  std::uint16_t u16() noexcept { return static_cast<std::uint16_t>(number(2, little_endian_)); }
  std::uint32_t u32() noexcept { return static_cast<std::uint32_t>(number(4, little_endian_)); }
  /// Of the parts of DDS Security that are big endian whatever the flags say, and of entity ids, which are bytes.
  std::uint32_t big_endian_u32() noexcept { return static_cast<std::uint32_t>(number(4, false)); }
  /// A sequence number: the high half comes first in both byte orders.
  std::int64_t sequence_number() noexcept {
    const std::uint64_t high = u32();
    return static_cast<std::int64_t>(high << 32U | u32());
  }
  std::array<unsigned char, 12> prefix() noexcept {
    std::array<unsigned char, 12> prefix{};
    for (unsigned char& byte : prefix) byte = u8();
    return prefix;
  }
  void skip(std::size_t count) noexcept { (void)part(count); }
  /// To the next multiple of four from the beginning of this part.
  void align() noexcept { skip(std::min((4 - at_ % 4) % 4, left())); }
  /// The next `count` bytes; empty if there are not so many.
  std::span<const unsigned char> part(std::size_t count) noexcept {
    if (count > left()) {
      failed_ = true;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  std::span<const unsigned char> rest() noexcept { return part(left()); }

 private:
  std::uint64_t number(std::size_t size, bool little_endian) noexcept {
    const auto bytes = part(size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value |= static_cast<std::uint64_t>(bytes[i]) << 8U * (little_endian ? i : bytes.size() - 1 - i);
    return value;
  }

  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
  bool little_endian_;
  bool failed_ = false;
};

}  // namespace aloft::bus::guard
