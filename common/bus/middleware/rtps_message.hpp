#pragma once

// The parts of an RTPS message: RTPS 2.2, 8.3.3 and 9.4.5; DDS Security 1.1, 7.3.6. No repair; the guard, the filter of
// clear text and the bad network of the tests use it.

#include <cstddef>

namespace aloft::bus::rtps_message {

enum Kind : unsigned {
  pad = 0x01,
  acknack = 0x06,
  heartbeat = 0x07,
  gap = 0x08,
  info_ts = 0x09,
  info_dst = 0x0e,
  nack_frag = 0x12,
  heartbeat_frag = 0x13,
  data = 0x15,
  data_frag = 0x16,
  sec_body = 0x30,
  sec_prefix = 0x31,
  sec_postfix = 0x32,
  first_of_vendors = 0x80,
  statistics = 0x80  // of eProsima, whose vendor id is 1.15: Fast DDS ends each message with it
};

// Ids of builtin writers, named by what they write: RTPS 2.2, 9.3.1.5; DDS Security 1.1, 7.4.7.
enum Writer : unsigned {
  announcements = 0x000100c2,
  clear_topics = 0x000002c2,
  clear_publications = 0x000003c2,
  clear_subscriptions = 0x000004c2,
  clear_liveliness = 0x000200c2,
  handshakes = 0x000201c3
};

inline constexpr std::size_t header_bytes = 20;

/// Calls `good(kind, content, size of the content)` for every submessage, as the middleware walks through them. False
/// as soon as `good` is false, or if the message is cut. The submessage's flags are the third byte before its content.
template <class Good>
bool all_submessages(const unsigned char* bytes, std::size_t size, const Good& good) {
  constexpr std::size_t submessage_header_bytes = 4;
  for (std::size_t at = header_bytes; at < size;) {
    if (size - at < submessage_header_bytes) return false;
    const unsigned kind = bytes[at];
    const bool little_endian = (bytes[at + 1] & 1U) != 0;
    std::size_t length = little_endian ? bytes[at + 2] + 256U * bytes[at + 3] : bytes[at + 3] + 256U * bytes[at + 2];
    at += submessage_header_bytes;
    if (length > size - at) return false;
    if (length == 0 && kind != info_ts && kind != pad) length = size - at;  // the last one
    if (!good(kind, bytes + at, length)) return false;
    at += (length + 3) & ~std::size_t{3};
  }
  return true;
}

}  // namespace aloft::bus::rtps_message
