#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/limits.hpp"
#include "common/bus/guard/parameter_check.hpp"
#include "common/bus/guard/refusal.hpp"

namespace aloft::bus::guard {

/// No valid sample of any topic is larger: an EpisodeRecord or a World, and 64 KiB for their other fields.
inline constexpr std::size_t largest_sample_bytes =
    std::max({limits::trace_bytes + limits::memory_bytes,
              (8 + 8 + 4) * limits::cells + 32 * limits::base_stations + 16 * limits::steps,  // a measured flight
              16 * limits::base_stations + 8 * limits::cells}) +                              // a city
    (64U << 10U);
/// Samples in fragments arrive in pieces of at least this size.
inline constexpr std::size_t smallest_fragment_bytes = 1024;
/// The middleware remembers each missing sample by itself, in 48 bytes.
inline constexpr std::int64_t widest_gap = 1 << 16;

/// What a datagram asks the middleware to remember, to be weighed against what its sender asked for before
/// (sender_limits.hpp).
struct Claims {
  struct Announcement {
    Prefix participant{};
    std::uint32_t lease_s = 0;
    bool leaving = false;
  };
  struct Fragments {
    std::uint32_t writer = 0;
    std::int64_t sequence_number = 0;
    std::uint32_t sample_bytes = 0;
    std::uint32_t total = 0;    ///< fragments of the sample
    std::uint32_t arrived = 0;  ///< of them in this datagram
  };

  Prefix sender{};
  std::vector<Announcement> announcements;
  std::vector<Fragments> fragments;
  std::int64_t missing = 0;  ///< samples that wide gaps declare missing
};

/// Whether a datagram is an RTPS message (RTPS 2.2; DDS Security 1.1) that a process of Aloft, or a foreign agent,
/// could have sent: Refusal::none, and what it claims; or what is wrong with it. Looks at nothing but the bytes, and
/// reads each at most a few times. The content of encrypted parts is not seen, only its frame.
[[nodiscard]] Refusal check_datagram(std::span<const unsigned char> datagram, Claims& claims);

}  // namespace aloft::bus::guard
