#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace aloft::bus {

/// Why a datagram is not handed to the middleware.
enum class Refusal : std::uint8_t {
  none,
  header,          ///< no RTPS message of version 2
  submessage,      ///< of no known kind, cut, or out of order
  sequence,        ///< a sequence number or a set of them that cannot be
  gap,             ///< declares more samples missing than are plausible
  heartbeat,       ///< ends before it begins
  fragment,        ///< of an impossible size or number, or of a sample larger than any topic has
  parameter,       ///< cut, or not of the size that its kind has
  locator,         ///< an address to which nothing can be sent
  duration,        ///< negative, or of an impossible fraction
  encapsulation,   ///< other than plain CDR (XCDR1), or a parameter list where discovery has one
  token,           ///< an authentication message that is not of its form
  content_filter,  ///< asks for a filter, which Aloft does not use
  endpoint,        ///< for a service of the middleware that Aloft does not use
  participants,    ///< announces more participants than a host can have
  pending,         ///< begins more samples than it completes
  rate             ///< too many from senders that have not announced themselves
};

inline constexpr std::array<std::string_view, 17> refusal_names{
    "none",           "header",    "submessage",   "sequence", "gap",           "heartbeat",
    "fragment",       "parameter", "locator",      "duration", "encapsulation", "token",
    "content_filter", "endpoint",  "participants", "pending",  "rate"};
static_assert(refusal_names.size() == static_cast<std::size_t>(Refusal::rate) + 1);

[[nodiscard]] constexpr std::string_view name(Refusal refusal) noexcept {
  return refusal_names.at(static_cast<std::size_t>(refusal));
}

/// Refused datagrams by reason; Refusal::none stays 0.
using RefusalCounts = std::array<std::uint64_t, refusal_names.size()>;

[[nodiscard]] constexpr std::uint64_t total(const RefusalCounts& counts) noexcept {
  std::uint64_t sum = 0;
  for (const std::uint64_t count : counts) sum += count;
  return sum;
}

}  // namespace aloft::bus
