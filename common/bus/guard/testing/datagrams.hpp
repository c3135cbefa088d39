#pragma once

// Datagrams made by hand, for tests of the guard.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/guard/parameter_check.hpp"

namespace aloft::bus::guard::testing {

using Bytes = std::vector<unsigned char>;

/// Writes numbers in one byte order.
class Out {
 public:
  explicit Out(bool little_endian) : little_endian_(little_endian) {}

  Out& u8(unsigned value) { return number(value, 1, true); }
  Out& u16(unsigned value) { return number(value, 2, little_endian_); }
  Out& u32(std::uint32_t value) { return number(value, 4, little_endian_); }
  Out& big_endian_u32(std::uint32_t value) { return number(value, 4, false); }
  Out& sequence_number(std::int64_t value) {
    return u32(static_cast<std::uint32_t>(static_cast<std::uint64_t>(value) >> 32U))
        .u32(static_cast<std::uint32_t>(value));
  }
  Out& bytes(const Bytes& more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
    return *this;
  }
  Out& fill(std::size_t count, unsigned char value = 0) { return bytes(Bytes(count, value)); }
  /// A length, the text, a 0, and padding to four bytes.
  Out& text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size() + 1)).bytes({text.begin(), text.end()}).u8(0);
    return align();
  }
  Out& align() { return fill((4 - bytes_.size() % 4) % 4); }
  [[nodiscard]] bool little_endian() const { return little_endian_; }
  [[nodiscard]] const Bytes& done() const { return bytes_; }

 private:
  Out& number(std::uint64_t value, std::size_t size, bool little_endian) {
    for (std::size_t i = 0; i < size; ++i)
      bytes_.push_back(static_cast<unsigned char>(value >> 8U * (little_endian ? i : size - 1 - i)));
    return *this;
  }

  Bytes bytes_;
  bool little_endian_;
};

inline Prefix prefix_of(std::uint32_t number) {
  Prefix prefix{1, 15, 7, 7, 7, 7, 7, 7};
  for (unsigned i = 0; i < 4; ++i) prefix[8 + i] = static_cast<unsigned char>(number >> 8U * i);
  return prefix;
}

inline Bytes header(const Prefix& sender = prefix_of(1)) {
  Bytes bytes(20);
  constexpr std::array<unsigned char, 8> beginning{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  std::copy(beginning.begin(), beginning.end(), bytes.begin());
  std::copy(sender.begin(), sender.end(), bytes.begin() + beginning.size());
  return bytes;
}

/// The header of a submessage, then what `content` writes. `flags` without that of the byte order.
inline Bytes submessage(unsigned kind, bool little_endian, unsigned flags, const std::function<void(Out&)>& content) {
  Out inner(little_endian);
  content(inner);
  Out out(little_endian);
  return out.u8(kind)
      .u8(flags | (little_endian ? 1U : 0U))
      .u16(static_cast<unsigned>(inner.done().size()))
      .bytes(inner.done())
      .done();
}

inline Bytes datagram(std::initializer_list<Bytes> submessages, const Prefix& sender = prefix_of(1)) {
  Bytes bytes = header(sender);
  for (const Bytes& part : submessages) bytes.insert(bytes.end(), part.begin(), part.end());
  return bytes;
}

/// A parameter: its number, its length, what `content` writes.
inline void parameter(Out& out, unsigned id, const std::function<void(Out&)>& content) {
  Out inner(out.little_endian());
  content(inner);
  out.u16(id).u16(static_cast<unsigned>(inner.done().size())).bytes(inner.done());
}

inline void end_of_parameters(Out& out) {
  out.u16(1).u16(0);
}

inline void locator(Out& out, std::uint32_t kind, std::uint32_t port, std::uint32_t address) {
  out.u32(kind).u32(port).fill(12).big_endian_u32(address);
}

inline constexpr std::uint32_t loopback = 0x7f000001;
inline constexpr std::uint32_t multicast = 0xefff0001;
inline constexpr unsigned announcements = 0x000100c2;
inline constexpr unsigned publications = 0x000003c2;
inline constexpr unsigned subscriptions = 0x000004c2;
inline constexpr unsigned liveliness = 0x000200c2;
inline constexpr unsigned handshakes = 0x000201c3;
inline constexpr unsigned of_a_user = 0x00000102;

/// DATA of `writer`, with a payload of the given encapsulation (0 and 1: CDR, 2 and 3: parameters).
inline Bytes data(bool little_endian, unsigned writer, unsigned encapsulation, const std::function<void(Out&)>& content,
                  std::int64_t number = 1) {
  return submessage(0x15, little_endian, 4, [&](Out& out) {
    out.u16(0).u16(16).big_endian_u32(0).big_endian_u32(writer).sequence_number(number);
    Out payload(little_endian);
    content(payload);
    out.u8(0).u8(encapsulation + (little_endian ? 1U : 0U)).u16(0).bytes(payload.done());
  });
}

/// Parameters of a builtin writer; `more` stands before the end mark.
inline Bytes discovery(bool little_endian, unsigned writer, const std::function<void(Out&)>& more) {
  return data(little_endian, writer, 2, [&](Out& out) {
    more(out);
    end_of_parameters(out);
  });
}

/// What a participant says of itself, and `more`.
inline Bytes announcement(bool little_endian, const Prefix& participant, std::uint32_t lease_s,
                          const std::function<void(Out&)>& more) {
  return discovery(little_endian, announcements, [&](Out& out) {
    parameter(out, 0x15, [](Out& value) { value.u8(2).u8(2).u16(0); });
    parameter(out, 0x16, [](Out& value) { value.u8(1).u8(15).u16(0); });
    parameter(out, 0x50, [&](Out& value) {
      value.bytes({participant.begin(), participant.end()}).big_endian_u32(0x1c1);
    });
    parameter(out, 0x02, [&](Out& value) { value.u32(lease_s).u32(0); });
    parameter(out, 0x32, [](Out& value) { locator(value, 1, 7410, loopback); });
    parameter(out, 0x33, [](Out& value) { locator(value, 1, 7400, multicast); });
    more(out);
  });
}

/// Says that a participant leaves.
inline Bytes farewell(bool little_endian, const Prefix& participant) {
  const auto guid = [&](Out& value) { value.bytes({participant.begin(), participant.end()}).big_endian_u32(0x1c1); };
  return submessage(0x15, little_endian, 2 | 8, [&](Out& out) {
    out.u16(0).u16(16).big_endian_u32(0).big_endian_u32(announcements).sequence_number(2);
    parameter(out, 0x70, guid);
    parameter(out, 0x71, [](Out& value) { value.big_endian_u32(3); });
    end_of_parameters(out);
    out.u8(0).u8(2U + (out.little_endian() ? 1U : 0U)).u16(0);
    parameter(out, 0x50, guid);
    end_of_parameters(out);
  });
}

struct Fragment {
  std::uint32_t first = 1;
  unsigned count = 1;
  unsigned fragment_bytes = 1024;
  std::uint32_t sample_bytes = 2048;
  std::size_t sent_bytes = 1024;
  unsigned writer = of_a_user;
};

inline Bytes data_frag(bool little_endian, const Fragment& fragment, std::int64_t number = 1) {
  return submessage(0x16, little_endian, 0, [&](Out& out) {
    out.u16(0).u16(28).big_endian_u32(0).big_endian_u32(fragment.writer).sequence_number(number);
    out.u32(fragment.first).u16(fragment.count).u16(fragment.fragment_bytes).u32(fragment.sample_bytes);
    out.fill(fragment.sent_bytes);
  });
}

inline Bytes heartbeat(bool little_endian, std::int64_t first, std::int64_t last, unsigned writer = of_a_user) {
  return submessage(0x07, little_endian, 0, [&](Out& out) {
    out.big_endian_u32(0).big_endian_u32(writer).sequence_number(first).sequence_number(last).u32(1);
  });
}

inline Bytes gap(bool little_endian, std::int64_t start, std::int64_t base, std::uint32_t bits = 0,
                 unsigned writer = of_a_user) {
  return submessage(0x08, little_endian, 0, [&](Out& out) {
    out.big_endian_u32(0).big_endian_u32(writer).sequence_number(start).sequence_number(base).u32(bits);
    out.fill(4 * std::min<std::size_t>(16, (bits + 31) / 32));
  });
}

inline Bytes acknack(bool little_endian, std::int64_t base, std::uint32_t bits) {
  return submessage(0x06, little_endian, 0, [&](Out& out) {
    out.big_endian_u32(0).big_endian_u32(of_a_user).sequence_number(base).u32(bits);
    out.fill(4 * std::min<std::size_t>(16, (bits + 31) / 32)).u32(1);
  });
}

/// An authentication message of one token, written by `token`.
inline Bytes handshake(bool little_endian, std::uint32_t tokens, const std::function<void(Out&)>& token) {
  return data(little_endian, handshakes, 0, [&](Out& out) {
    out.fill(96).text("dds.sec.auth").u32(tokens);
    token(out);
  });
}

inline void good_token(Out& out) {
  out.text("DDS:Auth:PKI-DH:1.0+Req");
  out.u32(1).text("dds.cert.sn").text("C=DE, CN=metrics");
  out.u32(1).text("c.id").u32(5).fill(5).align();
}

}  // namespace aloft::bus::guard::testing
