#pragma once

// One good datagram of each kind, and each way to spoil them. The unit test checks that each has its reason; the fault
// tests send them to the processes of a run.

#include <map>
#include <string>
#include <vector>

#include "common/bus/guard/datagram_check.hpp"
#include "common/bus/guard/testing/datagrams.hpp"

namespace aloft::bus::guard::testing {

inline Bytes endpoint(bool little, const std::function<void(Out&)>& more) {
  return discovery(little, publications, [&](Out& out) {
    parameter(out, 0x05, [](Out& value) { value.text("HeightCommand"); });
    parameter(out, 0x1a, [](Out& value) { value.u32(2).u32(0).u32(0x19999999); });
    parameter(out, 0x1b, [](Out& value) { value.u32(0).u32(0x7fffffff).u32(0xffffffff); });
    parameter(out, 0x29, [](Out& value) { value.u32(2).text("aloft/x").text("aloft/x/w0"); });
    parameter(out, 0x2c, [](Out& value) { value.u32(5).fill(5).align(); });
    parameter(out, 0x8001, [](Out& value) { value.fill(12); });  // of a vendor
    more(out);
  });
}

inline Bytes encrypted(bool little, std::uint32_t body_bytes = 8, std::uint32_t receivers = 1) {
  return datagram({submessage(0x31, little, 0, [](Out& out) { out.fill(20); }),
                   submessage(0x30, little, 0, [&](Out& out) { out.big_endian_u32(body_bytes).fill(8); }),
                   submessage(0x32, little, 0, [&](Out& out) { out.fill(16).big_endian_u32(receivers).fill(20); })});
}

inline void nothing(Out& /*out*/) {}

inline Bytes changed(Bytes bytes, std::size_t at, unsigned char value) {
  bytes.at(at) = value;
  return bytes;
}

inline Bytes statistics(bool little, std::size_t bytes) {
  return submessage(0x80, little, 0, [&](Out& out) { out.fill(bytes); });
}

/// One good datagram of each kind.
inline std::map<std::string, Bytes> good_datagrams(bool little) {
  const Bytes time = submessage(0x09, little, 0, [](Out& out) { out.u32(1).u32(2); });
  const Bytes no_time = submessage(0x09, little, 2, nothing);
  const Bytes to = submessage(0x0e, little, 0, [](Out& out) { out.fill(12, 9); });
  const Bytes sample = data(little, of_a_user, 0, [](Out& out) { out.fill(40); });
  const Bytes key = submessage(0x15, little, 2 | 8, [](Out& out) {
    out.u16(0).u16(16).big_endian_u32(0).big_endian_u32(of_a_user).sequence_number(9);
    parameter(out, 0x70, [](Out& value) { value.fill(16); });
    parameter(out, 0x71, [](Out& value) { value.big_endian_u32(3); });
    end_of_parameters(out);
    out.u8(0).u8(out.little_endian() ? 1 : 0).u16(0).u32(5);
  });
  return {
      {"nothing", datagram({})},
      {"sample", datagram({time, to, sample, no_time, sample})},
      {"padding", datagram({submessage(0x01, little, 0, nothing), sample})},
      {"key", datagram({key})},
      {"announcement", datagram({announcement(little, prefix_of(1), 20, nothing)})},
      {"secured announcement",
       datagram({announcement(little, prefix_of(1), 20, [](Out& out) { parameter(out, 0x1001, good_token); })})},
      {"farewell", datagram({farewell(little, prefix_of(1))})},
      {"endpoint", datagram({to, endpoint(little, nothing)})},
      {"liveliness", datagram({data(little, liveliness, 0, [](Out& out) { out.fill(16).u32(2).fill(2); })})},
      {"handshake", datagram({handshake(little, 1, good_token)})},
      {"heartbeat", datagram({to, heartbeat(little, 1, 0), heartbeat(little, 5, 900)})},
      {"acknack", datagram({to, acknack(little, 0, 0), acknack(little, 7, 256)})},
      {"gap", datagram({to, gap(little, 1, 2, 33), gap(little, 10, 10 + widest_gap)})},
      {"fragments",
       datagram({to, data_frag(little, {}), data_frag(little, {.first = 2, .sample_bytes = 1028, .sent_bytes = 4})})},
      {"nack_frag",
       datagram({submessage(0x12, little, 0,
                            [](Out& out) { out.fill(8).sequence_number(4).u32(2).u32(40).fill(8).u32(1); })})},
      {"heartbeat_frag",
       datagram({submessage(0x13, little, 0, [](Out& out) { out.fill(8).sequence_number(4).u32(9).u32(1); })})},
      {"encrypted", encrypted(little)},
      {"of a vendor", datagram({submessage(0x81, little, 0, [](Out& out) { out.fill(8, 3); }), sample})},
      {"of another vendor", changed(datagram({statistics(little, 8), sample}), 7, 16)},
      {"statistics", datagram({time, sample, statistics(little, 56)})},
  };
}

inline Bytes parameters(bool little, unsigned id, const std::function<void(Out&)>& value) {
  return datagram({endpoint(little, [&](Out& out) { parameter(out, id, value); })});
}

inline Bytes token(bool little, const std::function<void(Out&)>& value) {
  return datagram({announcement(little, prefix_of(1), 20, [&](Out& out) { parameter(out, 0x1001, value); })});
}

inline Bytes unicast(bool little, std::uint32_t kind, std::uint32_t port, std::uint32_t address) {
  return parameters(little, 0x2f, [&](Out& value) { locator(value, kind, port, address); });
}

struct Bad {
  std::string what;
  Refusal refusal;
  Bytes bytes;
};

inline constexpr std::int64_t too_large = (std::int64_t{1} << 48U) + 1;

inline std::vector<Bad> bad_messages(bool little) {
  const Bytes sample = datagram({data(little, of_a_user, 0, [](Out& out) { out.fill(40); })});
  const auto one = [&](unsigned kind, std::size_t bytes) {
    return datagram({submessage(kind, little, 0, [&](Out& out) { out.fill(bytes); })});
  };
  return {
      {"empty", Refusal::header, {}},
      {"magic", Refusal::header, changed(sample, 0, 'X')},
      {"version 1", Refusal::header, changed(sample, 4, 1)},
      {"version 3", Refusal::header, changed(sample, 4, 3)},
      {"vendor", Refusal::header, changed(sample, 6, 9)},
      {"no vendor", Refusal::header, changed(sample, 7, 0)},
      {"no sender", Refusal::header, datagram({}, Prefix{})},
      {"unknown kind", Refusal::submessage, one(0x40, 4)},
      {"another source", Refusal::submessage, one(0x0c, 20)},
      {"another address to reply to", Refusal::submessage, one(0x0f, 24)},
      {"the whole message encrypted", Refusal::submessage, one(0x33, 20)},
      {"short time", Refusal::submessage, one(0x09, 4)},
      {"short destination", Refusal::submessage, one(0x0e, 8)},
      {"short data", Refusal::submessage, one(0x15, 16)},
      {"inline parameters elsewhere", Refusal::submessage, changed(sample, 26, 99)},
      {"data and key", Refusal::submessage, changed(sample, 21, static_cast<unsigned char>(12 | (little ? 1 : 0)))},
      {"statistics before the end", Refusal::submessage, datagram({statistics(little, 56), statistics(little, 56)})},
      {"short statistics", Refusal::submessage, datagram({statistics(little, 8)})},
      {"long statistics", Refusal::submessage, datagram({statistics(little, 60)})},
      {"padding between submessages", Refusal::submessage,
       datagram({submessage(0x81, little, 0, [](Out& out) { out.fill(7); }), statistics(little, 56)})},
      {"body without prefix", Refusal::submessage, one(0x30, 12)},
      {"prefix without body", Refusal::submessage, one(0x31, 20)},
      {"encrypted body too long", Refusal::submessage, encrypted(little, 9)},
      {"too many receivers", Refusal::submessage, encrypted(little, 8, 0xffffffff)},
      {"sample number 0", Refusal::sequence, datagram({data(little, of_a_user, 0, nothing, 0)})},
      {"sample number -1", Refusal::sequence, datagram({data(little, of_a_user, 0, nothing, -1)})},
      {"sample number too large", Refusal::sequence, datagram({data(little, of_a_user, 0, nothing, too_large)})},
      {"set too large", Refusal::sequence, datagram({acknack(little, 1, 257)})},
      {"set far too large", Refusal::sequence, datagram({acknack(little, 1, 0xffffffff)})},
      {"acknowledged -1", Refusal::sequence, datagram({acknack(little, -1, 0)})},
      {"heartbeat from 0", Refusal::sequence, datagram({heartbeat(little, 0, 5)})},
      {"heartbeat to the end", Refusal::sequence, datagram({heartbeat(little, 1, INT64_MAX)})},
      {"heartbeat backwards", Refusal::heartbeat, datagram({heartbeat(little, 9, 7)})},
      {"gap backwards", Refusal::sequence, datagram({gap(little, 9, 9)})},
      {"gap from 0", Refusal::sequence, datagram({gap(little, 0, 9)})},
      {"set of a gap too large", Refusal::sequence, datagram({gap(little, 1, 2, 300)})},
      {"huge gap", Refusal::gap, datagram({gap(little, 1, 1'000'000'000)})},
      {"filter", Refusal::content_filter,
       parameters(little, 0x35, [](Out& value) { value.text("x").text("y").text("DDSSQL").text("((((a=1))))"); })},
      {"lookup of types", Refusal::endpoint, datagram({data(little, 0x000300c3, 0, [](Out& out) { out.fill(40); })})},
  };
}

inline std::vector<Bad> bad_fragments(bool little) {
  const auto fragment = [&](const Fragment& of) { return datagram({data_frag(little, of)}); };
  return {
      {"three bytes over", Refusal::fragment, fragment({.first = 2, .sample_bytes = 1027, .sent_bytes = 3})},
      {"tiny fragments", Refusal::fragment, fragment({.fragment_bytes = 1, .sent_bytes = 1})},
      {"no fragments", Refusal::fragment, fragment({.fragment_bytes = 0, .sent_bytes = 0})},
      {"odd fragments", Refusal::fragment, fragment({.fragment_bytes = 1025, .sent_bytes = 1025})},
      {"smaller than a fragment", Refusal::fragment, fragment({.sample_bytes = 3, .sent_bytes = 4})},
      {"too large a sample", Refusal::fragment, fragment({.sample_bytes = largest_sample_bytes + 1})},
      {"largest number", Refusal::fragment, fragment({.sample_bytes = 0xffffffff})},
      {"fragment 0", Refusal::fragment, fragment({.first = 0})},
      {"fragment beyond the sample", Refusal::fragment, fragment({.first = 3})},
      {"last of all numbers", Refusal::fragment, fragment({.first = 0xffffffff})},
      {"too many at once", Refusal::fragment, fragment({.count = 3, .sent_bytes = 2048})},
      {"none at once", Refusal::fragment, fragment({.count = 0})},
      {"fewer bytes", Refusal::fragment, fragment({.sent_bytes = 1020})},
      {"more bytes", Refusal::fragment, fragment({.sent_bytes = 1028})},
      {"discovery in fragments", Refusal::endpoint, fragment({.writer = announcements})},
      {"beyond what can be asked for", Refusal::fragment,
       datagram({submessage(0x12, little, 0,
                            [](Out& out) { out.fill(8).sequence_number(4).u32(0xfffffff0).u32(1).fill(8); })})},
      {"beyond what can be there", Refusal::fragment,
       datagram(
           {submessage(0x13, little, 0, [](Out& out) { out.fill(8).sequence_number(4).u32(0xffffffff).u32(1); })})},
      {"XCDR2 in fragments", Refusal::encapsulation, datagram({changed(data_frag(little, {}), 4 + 28 + 4 + 1 - 1, 7)})},
  };
}

inline std::vector<Bad> bad_parameters(bool little) {
  const auto representation = [&](unsigned writer, unsigned encapsulation) {
    return datagram({data(little, writer, encapsulation, [](Out& out) { end_of_parameters(out.fill(40)); })});
  };
  return {
      {"no end", Refusal::parameter, datagram({data(little, publications, 2, nothing)})},
      {"cut", Refusal::parameter, datagram({data(little, publications, 2, [](Out& out) { out.u16(0x2c).u16(400); })})},
      {"not a multiple of 4", Refusal::parameter, parameters(little, 0x8001, [](Out& value) { value.fill(3); })},
      {"short deadline", Refusal::parameter, parameters(little, 0x23, [](Out& value) { value.fill(4); })},
      {"long key", Refusal::parameter, parameters(little, 0x70, [](Out& value) { value.fill(20); })},
      {"text beyond its end", Refusal::parameter, parameters(little, 0x07, [](Out& value) { value.u32(9).fill(4); })},
      {"largest text", Refusal::parameter, parameters(little, 0x07, [](Out& value) { value.u32(0xffffffff).fill(4); })},
      {"text without end", Refusal::parameter, parameters(little, 0x07, [](Out& value) { value.u32(4).fill(4, 'x'); })},
      {"long text", Refusal::parameter,
       parameters(little, 0x07, [](Out& value) { value.text(std::string(400, 'x')); })},
      {"4 billion partitions", Refusal::parameter,
       parameters(little, 0x29, [](Out& value) { value.u32(0xffffffff).text("x"); })},
      {"more user data than there is", Refusal::parameter,
       parameters(little, 0x2c, [](Out& value) { value.u32(0xfffffffc).fill(8); })},
      {"a property's value beyond its end", Refusal::parameter,
       parameters(little, 0x59, [](Out& value) { value.u32(1).text("name").u32(0x40000000).fill(4); })},
      {"4 billion properties", Refusal::parameter,
       parameters(little, 0x59, [](Out& value) { value.u32(0xffffffff).text("name").text("value"); })},
      {"too many parameters", Refusal::parameter,
       datagram({endpoint(little,
                          [](Out& out) {
                            for (int i = 0; i < 300; ++i) parameter(out, 0x8001, nothing);
                          })})},
      {"nobody announced", Refusal::parameter, datagram({discovery(little, announcements, nothing)})},
      {"liveliness beyond its end", Refusal::parameter,
       datagram({data(little, liveliness, 0, [](Out& out) { out.fill(16).u32(400).fill(2); })})},
      {"port 0", Refusal::locator, unicast(little, 1, 0, loopback)},
      {"port 65536", Refusal::locator, unicast(little, 1, 65536, loopback)},
      {"no address", Refusal::locator, unicast(little, 1, 7410, 0)},
      {"broadcast", Refusal::locator, unicast(little, 1, 7410, 0xffffffff)},
      {"to one and to all", Refusal::locator, unicast(little, 1, 7410, multicast)},
      {"unknown transport", Refusal::locator, unicast(little, 77, 7410, loopback)},
      {"negative duration", Refusal::duration, parameters(little, 0x23, [](Out& v) { v.u32(0x80000000).u32(0); })},
      {"a fraction that is a second", Refusal::duration,
       parameters(little, 0x23, [](Out& v) { v.u32(1).u32(0xffffffff); })},
      {"endless lease", Refusal::duration, datagram({announcement(little, prefix_of(1), 0x7fffffff, nothing)})},
      {"no lease", Refusal::duration, datagram({announcement(little, prefix_of(1), 0, nothing)})},
      {"XCDR2", Refusal::encapsulation, representation(of_a_user, 6)},
      {"parameters of a user", Refusal::encapsulation, representation(of_a_user, 2)},
      {"discovery that is no list", Refusal::encapsulation, representation(publications, 0)},
      {"no encapsulation", Refusal::encapsulation,
       datagram(
           {submessage(0x15, little, 4, [](Out& out) { out.u16(0).u16(16).fill(4).fill(4).sequence_number(1); })})},
  };
}

inline std::vector<Bad> bad_tokens(bool little) {
  constexpr std::uint32_t wraps = 0xfffffffd;  // rounded up to four bytes it is 0
  return {
      {"tokens: largest count", Refusal::token, datagram({handshake(little, 0xffffffff, good_token)})},
      {"tokens: fewer than said", Refusal::token, datagram({handshake(little, 2, good_token)})},
      {"token: class beyond its end", Refusal::token, token(little, [](Out& out) { out.u32(wraps).fill(8); })},
      {"token: properties", Refusal::token, token(little, [](Out& out) { out.text("c").u32(0x10000001).fill(16); })},
      {"token: property", Refusal::token, token(little, [](Out& out) { out.text("c").u32(1).u32(wraps).fill(16); })},
      {"token: binary properties", Refusal::token,
       token(little, [](Out& out) { out.text("c").u32(0).u32(0x20000001).fill(16); })},
      {"token: name of a binary property", Refusal::token,
       token(little, [](Out& out) { out.text("c").u32(0).u32(1).u32(wraps).fill(16); })},
      {"token: value of a binary property", Refusal::token,
       token(little, [](Out& out) { out.text("c").u32(0).u32(1).text("n").u32(wraps).fill(16); })},
      {"handshake: class beyond its end", Refusal::token,
       datagram({data(little, handshakes, 0, [](Out& out) { out.fill(96).u32(0xfffffff0).fill(8); })})},
  };
}

inline std::vector<Bad> bad_datagrams(bool little) {
  std::vector<Bad> all;
  for (auto list : {bad_messages(little), bad_fragments(little), bad_parameters(little), bad_tokens(little)})
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace aloft::bus::guard::testing
