#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/guard/refusal.hpp"
#include "common/bus/guard/wire_bytes.hpp"

namespace aloft::bus::guard {

using Prefix = std::array<unsigned char, 12>;

/// What a list of parameters says of a participant.
struct ParticipantFacts {
  std::optional<Prefix> participant;  ///< from its GUID or a key hash
  std::uint32_t lease_s = 100;        ///< rounded up; RTPS's default
  bool leaving = false;
};

/// Checks a list of parameters (RTPS 2.2, 9.4.2.11) up to and including its end mark, and stands behind it then. Every
/// parameter lies within the list; those that the middleware reads have the size of their kind, counts that their bytes
/// can hold, possible durations, and addresses that can be sent to.
[[nodiscard]] Refusal check_parameters(WireBytes& list, ParticipantFacts& facts);

/// Checks a DataHolder (DDS Security 1.1, 7.2.3): a text, texts by name, bytes by name.
[[nodiscard]] Refusal check_token(WireBytes& in);

}  // namespace aloft::bus::guard
