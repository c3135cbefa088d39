#include "common/bus/guard/datagram_check.hpp"

#include "common/bus/middleware/rtps_message.hpp"

namespace aloft::bus::guard {
namespace {

using namespace rtps_message;

// 2^48 samples would take 8900 years at 1000 a second; sums of two such numbers do not overflow.
constexpr std::int64_t max_sequence_number = std::int64_t{1} << 48U;
constexpr std::uint32_t max_bits = 256;  // of a set: RTPS 2.2, 9.4.2.6
constexpr std::uint32_t max_fragments = largest_sample_bytes / smallest_fragment_bytes + 1;
constexpr std::uint32_t padding = 3;  // at the end of a submessage

constexpr unsigned has_inline_qos = 2;
constexpr unsigned has_data = 4;
constexpr unsigned has_key = 8;
constexpr unsigned fragment_has_key = 4;
constexpr unsigned no_time = 2;

/// The representations of RTPS 2.2, 10.5; others, such as XCDR2, are not used here.
enum Encapsulation : std::uint16_t { cdr_be = 0, cdr_le = 1, list_be = 2, list_le = 3 };

struct Submessage {
  unsigned kind;
  unsigned flags;
  std::span<const unsigned char> content;

  [[nodiscard]] WireBytes bytes() const { return {content, (flags & 1U) != 0}; }
};

bool builtin(std::uint32_t writer) {
  return (writer & 0xc0U) == 0xc0;
}

/// Secured twins of the builtin writers differ from the clear ones by the first byte.
std::uint32_t in_clear(std::uint32_t writer) {
  return writer >> 24U == 0xff ? writer & 0xffffffU : writer;
}

bool writes_parameters(std::uint32_t writer) {
  constexpr unsigned secured_announcements = 0x000101c2;
  const std::uint32_t id = in_clear(writer);
  return id == announcements || id == secured_announcements || id == clear_topics || id == clear_publications ||
         id == clear_subscriptions;
}

bool type_lookup(std::uint32_t writer) {
  return writer >> 8U == 0x000300 || writer >> 8U == 0x000301;
}

bool possible(std::int64_t sequence_number) {
  return sequence_number >= 1 && sequence_number <= max_sequence_number;
}

/// A set of numbers: its base is read before, then the number of bits and the bits.
bool skip_bits(WireBytes& in) {
  const std::uint32_t bits = in.u32();
  if (bits > max_bits) return false;
  in.skip(4 * ((bits + 31) / 32));
  return !in.failed();
}

/// Frames of what is encrypted: prefix, body, postfix, in this order.
class SecuredFrames {
 public:
  Refusal check(const Submessage& submessage) {
    const bool in_order = submessage.kind == expected_ || (expected_ == sec_prefix && !secured(submessage.kind));
    if (!in_order) return Refusal::submessage;
    if (!secured(submessage.kind)) return Refusal::none;
    WireBytes in = submessage.bytes();
    if (submessage.kind == sec_prefix) {
      expected_ = sec_body;
      in.skip(header_bytes);
    } else if (submessage.kind == sec_body) {
      expected_ = sec_postfix;
      in.skip(in.big_endian_u32());
    } else {
      expected_ = sec_prefix;
      in.skip(common_code_bytes);
      const std::uint32_t receivers = in.big_endian_u32();
      if (receivers > in.left() / receiver_code_bytes) return Refusal::submessage;
    }
    return in.failed() ? Refusal::submessage : Refusal::none;
  }
  [[nodiscard]] bool complete() const { return expected_ == sec_prefix; }

 private:
  static constexpr std::size_t header_bytes = 20;
  static constexpr std::size_t common_code_bytes = 16;
  static constexpr std::size_t receiver_code_bytes = 20;

  static bool secured(unsigned kind) { return kind == sec_prefix || kind == sec_body || kind == sec_postfix; }

  unsigned expected_ = sec_prefix;
};

Refusal check_time(const Submessage& submessage) {
  if ((submessage.flags & no_time) != 0) return Refusal::none;
  return submessage.content.size() >= 8 ? Refusal::none : Refusal::submessage;
}

Refusal check_acknack(const Submessage& submessage) {
  WireBytes in = submessage.bytes();
  in.skip(8);
  const std::int64_t base = in.sequence_number();
  const bool bits = skip_bits(in);
  in.skip(4);
  if (in.failed()) return Refusal::submessage;
  // Readers that know nothing of the writer yet send an empty set at 0.
  return bits && base >= 0 && base <= max_sequence_number ? Refusal::none : Refusal::sequence;
}

Refusal check_heartbeat(const Submessage& submessage) {
  WireBytes in = submessage.bytes();
  in.skip(8);
  const std::int64_t first = in.sequence_number();
  const std::int64_t last = in.sequence_number();
  in.skip(4);
  if (in.failed()) return Refusal::submessage;
  if (!possible(first) || last > max_sequence_number) return Refusal::sequence;
  return last >= first - 1 ? Refusal::none : Refusal::heartbeat;
}

Refusal check_gap(const Submessage& submessage, Claims& claims) {
  constexpr std::int64_t answered_at_once = 256;  // one acknowledgement asks for no more
  WireBytes in = submessage.bytes();
  in.skip(8);
  const std::int64_t start = in.sequence_number();
  const std::int64_t base = in.sequence_number();
  const bool bits = skip_bits(in);
  if (in.failed()) return Refusal::submessage;
  if (!bits || !possible(start) || !possible(base) || base <= start) return Refusal::sequence;
  if (base - start > widest_gap) return Refusal::gap;
  if (base - start > answered_at_once) claims.missing += base - start;
  return Refusal::none;
}

Refusal check_nack_frag(const Submessage& submessage) {
  WireBytes in = submessage.bytes();
  in.skip(8);
  const std::int64_t number = in.sequence_number();
  const std::uint32_t base = in.u32();
  const bool bits = skip_bits(in);
  in.skip(4);
  if (in.failed()) return Refusal::submessage;
  if (!bits || !possible(number)) return Refusal::sequence;
  return base >= 1 && base <= max_fragments ? Refusal::none : Refusal::fragment;
}

Refusal check_heartbeat_frag(const Submessage& submessage) {
  WireBytes in = submessage.bytes();
  in.skip(8);
  const std::int64_t number = in.sequence_number();
  const std::uint32_t last = in.u32();
  in.skip(4);
  if (in.failed()) return Refusal::submessage;
  if (!possible(number)) return Refusal::sequence;
  return last >= 1 && last <= max_fragments ? Refusal::none : Refusal::fragment;
}

/// An authentication message, ParticipantGenericMessage (DDS Security 1.1, 7.4.4.3).
Refusal check_handshake(WireBytes in) {
  constexpr std::size_t addresses_bytes = 96;  // who answers what, from whom and for whom
  constexpr std::uint32_t max_class_bytes = 256;
  constexpr std::uint32_t max_tokens = 16;
  in.skip(addresses_bytes);
  const std::uint32_t class_bytes = in.u32();
  in.skip(class_bytes);
  in.align();
  const std::uint32_t tokens = in.u32();
  if (in.failed() || class_bytes > max_class_bytes || tokens > max_tokens) return Refusal::token;
  for (std::uint32_t i = 0; i < tokens; ++i)
    if (const Refusal refusal = check_token(in); refusal != Refusal::none) return refusal;
  return Refusal::none;
}

/// ParticipantMessageData (RTPS 2.2, 9.6.2.1): a participant's prefix, a kind, and bytes.
Refusal check_liveliness(WireBytes in) {
  in.skip(16);
  in.skip(in.u32());
  return in.failed() ? Refusal::parameter : Refusal::none;
}

/// What a DATA submessage carries.
Refusal check_payload(std::uint32_t writer, std::span<const unsigned char> payload, bool key, ParticipantFacts& facts) {
  WireBytes header(payload, false);
  const std::uint16_t encapsulation = header.u16();
  header.skip(2);  // options
  if (header.failed() || encapsulation > list_le) return Refusal::encapsulation;
  WireBytes in(header.rest(), encapsulation == cdr_le || encapsulation == list_le);
  const bool parameters = encapsulation == list_be || encapsulation == list_le;
  if (!key && parameters != writes_parameters(writer)) return Refusal::encapsulation;
  if (parameters) return check_parameters(in, facts);
  if (key) return Refusal::none;
  if (writer == handshakes) return check_handshake(in);
  if (writer == clear_liveliness) return check_liveliness(in);
  return Refusal::none;
}

/// The beginning of DATA and DATA_FRAG: flags for later versions, where inline parameters begin, reader, writer,
/// number.
struct Origin {
  Origin(WireBytes& in, std::uint16_t parameters_at) {
    in.skip(2);
    const std::uint16_t offset = in.u16();
    in.skip(4);
    writer = in.big_endian_u32();
    sequence_number = in.sequence_number();
    good = offset == parameters_at;
  }
  std::uint32_t writer;
  std::int64_t sequence_number;
  bool good;
};

Refusal check_data(const Submessage& submessage, Claims& claims) {
  WireBytes in = submessage.bytes();
  const Origin origin(in, 16);
  const bool data = (submessage.flags & has_data) != 0;
  const bool key = (submessage.flags & has_key) != 0;
  if (in.failed() || !origin.good || (data && key)) return Refusal::submessage;
  if (!possible(origin.sequence_number)) return Refusal::sequence;
  if (type_lookup(origin.writer)) return Refusal::endpoint;
  ParticipantFacts facts;
  if ((submessage.flags & has_inline_qos) != 0)
    if (const Refusal refusal = check_parameters(in, facts); refusal != Refusal::none) return refusal;
  if (data || key)
    if (const Refusal refusal = check_payload(origin.writer, in.rest(), key, facts); refusal != Refusal::none)
      return refusal;
  if (origin.writer == announcements) {
    if (!facts.participant) return Refusal::parameter;
    claims.announcements.push_back(
        {.participant = *facts.participant, .lease_s = facts.lease_s, .leaving = facts.leaving || !data});
  }
  return Refusal::none;
}

Refusal check_data_frag(const Submessage& submessage, Claims& claims) {
  WireBytes in = submessage.bytes();
  const Origin origin(in, 28);
  const std::uint64_t first = in.u32();
  const std::uint64_t count = in.u16();
  const std::uint64_t fragment_bytes = in.u16();
  const std::uint64_t sample_bytes = in.u32();
  if (in.failed() || !origin.good || (submessage.flags & fragment_has_key) != 0) return Refusal::submessage;
  if (!possible(origin.sequence_number)) return Refusal::sequence;
  // What participants say of themselves fits a datagram; in fragments it would get past the checks of its content.
  if (builtin(origin.writer)) return Refusal::endpoint;
  ParticipantFacts facts;
  if ((submessage.flags & has_inline_qos) != 0)
    if (const Refusal refusal = check_parameters(in, facts); refusal != Refusal::none) return refusal;
  // The middleware keeps a list of missing fragments in their own place, as numbers of four bytes: so each must have
  // room for one. Our writers pad their samples (CheckedType).
  constexpr std::uint64_t smallest_last_bytes = 4;
  const bool sizes = fragment_bytes >= smallest_fragment_bytes && fragment_bytes % 4 == 0 &&
                     sample_bytes > fragment_bytes && sample_bytes <= largest_sample_bytes &&
                     (sample_bytes - 1) % fragment_bytes + 1 >= smallest_last_bytes;
  if (!sizes || first == 0 || count == 0) return Refusal::fragment;
  const std::uint64_t total = (sample_bytes + fragment_bytes - 1) / fragment_bytes;
  if (first + count - 1 > total) return Refusal::fragment;
  const std::uint64_t expected =
      std::min(sample_bytes, (first - 1 + count) * fragment_bytes) - (first - 1) * fragment_bytes;
  const auto content = in.rest();
  if (content.size() < expected || content.size() > expected + padding) return Refusal::fragment;
  if (first == 1 && (content[0] != 0 || content[1] > cdr_le)) return Refusal::encapsulation;
  claims.fragments.push_back({.writer = origin.writer,
                              .sequence_number = origin.sequence_number,
                              .sample_bytes = static_cast<std::uint32_t>(sample_bytes),
                              .total = static_cast<std::uint32_t>(total),
                              .arrived = static_cast<std::uint32_t>(count)});
  return Refusal::none;
}

Refusal check_submessage(const Submessage& submessage, Claims& claims) {
  switch (submessage.kind) {
    case pad:
    case sec_prefix:
    case sec_body:
    case sec_postfix:
      return Refusal::none;
    case info_ts:
      return check_time(submessage);
    case info_dst:
      return submessage.content.size() >= Prefix{}.size() ? Refusal::none : Refusal::submessage;
    case acknack:
      return check_acknack(submessage);
    case heartbeat:
      return check_heartbeat(submessage);
    case gap:
      return check_gap(submessage, claims);
    case nack_frag:
      return check_nack_frag(submessage);
    case heartbeat_frag:
      return check_heartbeat_frag(submessage);
    case data:
      return check_data(submessage, claims);
    case data_frag:
      return check_data_frag(submessage, claims);
    default:
      return submessage.kind >= first_of_vendors ? Refusal::none : Refusal::submessage;
  }
}

/// Where a submessage may stand. Fast DDS ends if its statistics are not exactly the end of a message, and some
/// versions look for them without skipping the padding between submessages.
Refusal check_place(const Submessage& submessage, std::span<const unsigned char> datagram) {
  constexpr std::size_t statistics_bytes = 56;
  const bool last = submessage.content.data() + submessage.content.size() == datagram.data() + datagram.size();
  if (!last && submessage.content.size() % 4 != 0) return Refusal::submessage;
  const bool of_fast_dds = datagram[6] == 1 && datagram[7] == 15;
  if (!of_fast_dds || submessage.kind != statistics) return Refusal::none;
  return last && submessage.content.size() == statistics_bytes ? Refusal::none : Refusal::submessage;
}

Refusal check_header(std::span<const unsigned char> datagram, Claims& claims) {
  constexpr std::array<unsigned char, 4> magic{'R', 'T', 'P', 'S'};
  constexpr unsigned char version = 2;
  if (datagram.size() < header_bytes || !std::equal(magic.begin(), magic.end(), datagram.begin()))
    return Refusal::header;
  // The OMG gives out vendor ids from 1.1 on.
  if (datagram[4] != version || datagram[6] != 1 || datagram[7] == 0) return Refusal::header;
  std::copy_n(datagram.begin() + 8, claims.sender.size(), claims.sender.begin());
  return claims.sender == Prefix{} ? Refusal::header : Refusal::none;
}

}  // namespace

Refusal check_datagram(std::span<const unsigned char> datagram, Claims& claims) {
  Refusal refusal = check_header(datagram, claims);
  if (refusal != Refusal::none) return refusal;
  SecuredFrames frames;
  const bool whole = all_submessages(
      datagram.data(), datagram.size(), [&](unsigned kind, const unsigned char* content, std::size_t size) {
        const Submessage submessage{.kind = kind, .flags = content[-3], .content = {content, size}};
        refusal = check_place(submessage, datagram);
        if (refusal == Refusal::none) refusal = frames.check(submessage);
        if (refusal == Refusal::none) refusal = check_submessage(submessage, claims);
        return refusal == Refusal::none;
      });
  if (refusal != Refusal::none) return refusal;
  return whole && frames.complete() ? Refusal::none : Refusal::submessage;
}

}  // namespace aloft::bus::guard
