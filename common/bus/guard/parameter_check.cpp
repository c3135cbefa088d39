#include "common/bus/guard/parameter_check.hpp"

#include <algorithm>

namespace aloft::bus::guard {
namespace {

// Far more than any participant announces.
constexpr std::size_t max_parameters = 256;
constexpr std::size_t max_elements = 64;
constexpr std::size_t max_text_bytes = 256;
constexpr std::size_t max_property_bytes = 4096;
constexpr std::size_t max_octets = 4096;
// A longer lease would keep a forged participant in memory for as long.
constexpr std::uint32_t max_lease_s = 300;

enum class Form : std::uint8_t {
  bytes,       // of exactly this size
  text,        // of at most this size
  texts,       // a sequence of texts
  octets,      // a sequence of bytes
  duration,    // of exactly this size, with a duration at an offset
  unicast,     // a locator
  multicast,   // a locator
  properties,  // pairs of texts, then pairs of a text and bytes
  token,
  filter,
  words16,  // a sequence of 16-bit numbers
};

struct Known {
  std::uint16_t id;
  Form form;
  std::uint16_t size = 0;
  std::uint16_t offset = 0;
};

constexpr std::uint16_t pad = 0x0000;
constexpr std::uint16_t sentinel = 0x0001;
constexpr std::uint16_t participant_lease = 0x0002;
constexpr std::uint16_t participant_guid = 0x0050;
constexpr std::uint16_t key_hash = 0x0070;
constexpr std::uint16_t status_info = 0x0071;

// RTPS 2.2, table 9.14; DDS Security 1.1, 7.4.1. In ascending order.
constexpr std::array known_parameters{
    Known{participant_lease, Form::duration, 8},
    Known{0x0004, Form::bytes, 8},         // time based filter
    Known{0x0005, Form::text},             // topic name
    Known{0x0006, Form::bytes, 4},         // ownership strength
    Known{0x0007, Form::text},             // type name
    Known{0x000f, Form::bytes, 4},         // domain id
    Known{0x0015, Form::bytes, 4},         // protocol version
    Known{0x0016, Form::bytes, 4},         // vendor
    Known{0x001a, Form::duration, 12, 4},  // reliability
    Known{0x001b, Form::duration, 12, 4},  // liveliness
    Known{0x001d, Form::bytes, 4},         // durability
    Known{0x001e, Form::duration, 28},     // durability service
    Known{0x001f, Form::bytes, 4},         // ownership
    Known{0x0021, Form::bytes, 8},         // presentation
    Known{0x0023, Form::duration, 8},      // deadline
    Known{0x0025, Form::bytes, 4},         // destination order
    Known{0x0027, Form::duration, 8},      // latency budget
    Known{0x0029, Form::texts},            // partition
    Known{0x002b, Form::duration, 8},      // lifespan
    Known{0x002c, Form::octets},           // user data
    Known{0x002d, Form::octets},           // group data
    Known{0x002e, Form::octets},           // topic data
    Known{0x002f, Form::unicast, 24},
    Known{0x0030, Form::multicast, 24},
    Known{0x0031, Form::unicast, 24},    // default
    Known{0x0032, Form::unicast, 24},    // of discovery
    Known{0x0033, Form::multicast, 24},  // of discovery
    Known{0x0034, Form::bytes, 4},       // liveliness count
    Known{0x0035, Form::filter},
    Known{0x0040, Form::bytes, 8},       // history
    Known{0x0041, Form::bytes, 12},      // resource limits
    Known{0x0043, Form::bytes, 4},       // expects inline quality of service
    Known{0x0044, Form::bytes, 4},       // builtin endpoints
    Known{0x0048, Form::multicast, 24},  // default
    Known{0x0049, Form::bytes, 4},       // transport priority
    Known{participant_guid, Form::bytes, 16},
    Known{0x0052, Form::bytes, 16},  // group
    Known{0x0053, Form::bytes, 4},   // group's entity
    Known{0x0055, Form::filter},     // which filters a sample passed
    Known{0x0058, Form::bytes, 4},   // set of builtin endpoints
    Known{0x0059, Form::properties},
    Known{0x005a, Form::bytes, 16},  // endpoint
    Known{0x0060, Form::bytes, 4},   // largest sample
    Known{0x0062, Form::text},       // name of the entity
    Known{key_hash, Form::bytes, 16},
    Known{status_info, Form::bytes, 4},
    Known{0x0073, Form::words16},    // data representation
    Known{0x0077, Form::bytes, 4},   // quality of service of builtin endpoints
    Known{0x0083, Form::bytes, 24},  // related sample
    Known{0x1001, Form::token},      // identity
    Known{0x1002, Form::token},      // permissions
    Known{0x1004, Form::bytes, 8},   // endpoint security
    Known{0x1005, Form::bytes, 8},   // participant security
    Known{0x1006, Form::token},      // identity status
    Known{0x4014, Form::text},       // domain tag
    Known{0x800f, Form::bytes, 24},  // related sample, by its number at eProsima
};
static_assert(std::is_sorted(known_parameters.begin(), known_parameters.end(),
                             [](const Known& a, const Known& b) { return a.id < b.id; }));

/// A length, then so many bytes, the last of which is 0; a length of 0 stands for no text.
bool text(WireBytes& in, std::size_t max_bytes) {
  const std::uint32_t length = in.u32();
  const auto bytes = in.part(length);
  in.align();
  return !in.failed() && length <= max_bytes && (length == 0 || bytes.back() == 0);
}

bool octets(WireBytes& in, std::size_t max_bytes) {
  const std::uint32_t length = in.u32();
  in.skip(length);
  in.align();
  return !in.failed() && length <= max_bytes;
}

/// A count, then so many elements, each read by `element`.
template <class Element>
bool sequence(WireBytes& in, const Element& element) {
  const std::uint32_t count = in.u32();
  if (in.failed() || count > max_elements) return false;
  for (std::uint32_t i = 0; i < count; ++i)
    if (!element()) return false;
  return true;
}

bool pairs(WireBytes& in, std::size_t max_value_bytes) {
  const auto property = [&] {
    const bool name = text(in, max_property_bytes);
    return name && text(in, max_property_bytes);
  };
  if (!sequence(in, property)) return false;
  // Participants that have no binary properties leave their count out.
  return in.left() == 0 || sequence(in, [&] { return text(in, max_property_bytes) && octets(in, max_value_bytes); });
}

Refusal check_duration(WireBytes in, const Known& known, ParticipantFacts& facts) {
  in.skip(known.offset);
  const std::uint32_t seconds = in.u32();
  const std::uint32_t fraction = in.u32();
  constexpr std::uint32_t max_seconds = 0x7fffffff;
  // From here on the fraction, rounded to nanoseconds, is a whole second.
  constexpr std::uint32_t first_whole = 0xfffffffe;
  const bool infinite = seconds == max_seconds;
  if (seconds > max_seconds || (fraction >= first_whole && !infinite)) return Refusal::duration;
  if (known.id != participant_lease) return Refusal::none;
  facts.lease_s = seconds + (fraction > 0 ? 1 : 0);
  return facts.lease_s > 0 && facts.lease_s <= max_lease_s ? Refusal::none : Refusal::duration;
}

Refusal check_locator(WireBytes in, Form form) {
  enum Kind : std::uint32_t {
    udp4 = 1,
    udp6 = 2,
    tcp4 = 4,
    tcp6 = 8,
    shared_memory = 16,
    fast_dds_shared_memory = 1U << 24U
  };
  constexpr std::uint32_t max_port = 65'535;
  const std::uint32_t kind = in.u32();
  const std::uint32_t port = in.u32();
  in.skip(12);
  const std::uint32_t address = in.big_endian_u32();
  switch (kind) {
    case tcp4:  // other numbers are in the upper half of the port
    case tcp6:
    case udp6:
    case shared_memory:
    case fast_dds_shared_memory:
      return Refusal::none;  // no transport of ours sends there
    case udp4: {
      const bool multicast = address >> 28U == 0xe;
      const bool reserved = address >> 28U == 0xf || address == 0;
      return port == 0 || port > max_port || reserved || multicast != (form == Form::multicast) ? Refusal::locator
                                                                                                : Refusal::none;
    }
    default:
      return Refusal::locator;
  }
}

Refusal sized(bool good, Refusal otherwise = Refusal::parameter) {
  return good ? Refusal::none : otherwise;
}

Refusal check_known(const Known& known, WireBytes value, ParticipantFacts& facts) {
  const bool right_size = value.left() == known.size;
  switch (known.form) {
    case Form::bytes:
      return sized(right_size);
    case Form::duration:
      return right_size ? check_duration(value, known, facts) : Refusal::parameter;
    case Form::unicast:
    case Form::multicast:
      return right_size ? check_locator(value, known.form) : Refusal::parameter;
    case Form::text:
      return sized(text(value, max_text_bytes));
    case Form::texts:
      return sized(sequence(value, [&] { return text(value, max_text_bytes); }));
    case Form::octets:
      return sized(octets(value, max_octets));
    case Form::words16:
      return sized(sequence(value, [&] {
        value.skip(2);
        return !value.failed();
      }));
    case Form::properties:
      return sized(pairs(value, max_octets));
    case Form::token:
      return check_token(value);
    case Form::filter:
      return Refusal::content_filter;
  }
  return Refusal::none;
}

void take_facts(std::uint16_t id, WireBytes value, ParticipantFacts& facts) {
  if (id == participant_guid || (id == key_hash && !facts.participant)) facts.participant = value.prefix();
  if (id == status_info) facts.leaving = (value.big_endian_u32() & 3U) != 0;
}

}  // namespace

Refusal check_token(WireBytes& in) {
  const std::size_t max_value_bytes = in.left();  // certificates and permissions: as many as there are
  return sized(text(in, max_text_bytes) && pairs(in, max_value_bytes), Refusal::token);
}

Refusal check_parameters(WireBytes& list, ParticipantFacts& facts) {
  for (std::size_t count = 0; count < max_parameters; ++count) {
    const std::uint16_t id = list.u16();
    const std::uint16_t length = list.u16();
    if (list.failed()) return Refusal::parameter;
    if (id == sentinel) return Refusal::none;
    const auto bytes = list.part(length);
    if (list.failed() || length % 4 != 0) return Refusal::parameter;
    if (id == pad) continue;
    const auto known = std::lower_bound(known_parameters.begin(), known_parameters.end(), id,
                                        [](const Known& a, std::uint16_t wanted) { return a.id < wanted; });
    if (known == known_parameters.end() || known->id != id) continue;
    const WireBytes value(bytes, list.little_endian());
    if (const Refusal refusal = check_known(*known, value, facts); refusal != Refusal::none) return refusal;
    take_facts(id, value, facts);
  }
  return Refusal::parameter;
}

}  // namespace aloft::bus::guard
