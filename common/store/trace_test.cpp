#include <bit>
#include <catch2/catch.hpp>
#include <limits>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"

using namespace aloft;
using agents::Action;
using flight::FlightRecord;
using store::decode_trace;
using store::encode_trace;

namespace {

/// Two steps with every field in use.
FlightRecord full_record() {
  FlightRecord record;
  record.qos_kind = radio::QosKind::throughput;
  record.height_start_m = 20.0;
  record.pilots = {"dqn", "min-height"};
  record.steps.push_back({1, Action::up, 1.5, -2.5, 30.0, 7, 3.25, 41000.5, 41000.5, 0, {}});
  record.steps.push_back({2,
                          Action::absolute,
                          11.5,
                          -0.0,
                          120.0,
                          -1,
                          -std::numeric_limits<double>::infinity(),
                          0.0,
                          -1.0,
                          1,
                          agents::Introspection{0.9, 0.125, {1.0, 2.0, 3.0}},
                          {2, 1, 3, 0.25}});
  return record;
}

/// Unlike ==, tells 0 from -0.
bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool equal(const FlightRecord& a, const FlightRecord& b) {
  const auto same_step = [](const flight::StepRecord& s, const flight::StepRecord& t) {
    const bool same_thoughts = s.introspection.has_value() == t.introspection.has_value() &&
                               (!s.introspection || (s.introspection->epsilon == t.introspection->epsilon &&
                                                     s.introspection->loss == t.introspection->loss &&
                                                     s.introspection->q_values == t.introspection->q_values));
    return s.step == t.step && s.action == t.action && same_bits(s.x_m, t.x_m) && same_bits(s.y_m, t.y_m) &&
           same_bits(s.height_m, t.height_m) && s.serving_cell == t.serving_cell &&
           same_bits(s.serving_sinr_db, t.serving_sinr_db) && same_bits(s.qos, t.qos) &&
           same_bits(s.reward, t.reward) && s.flown_by == t.flown_by && same_thoughts && s.mobility == t.mobility;
  };
  return a.qos_kind == b.qos_kind && a.height_start_m == b.height_start_m && a.pilots == b.pilots &&
         std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), b.steps.end(), same_step);
}

}  // namespace

TEST_CASE("a trace comes back as it was, and gives the same bytes again") {
  FlightRecord record = full_record();
  const std::string bytes = encode_trace(record);
  CHECK(equal(decode_trace(bytes), record));
  CHECK(encode_trace(decode_trace(bytes)) == bytes);
  record.steps.at(1).y_m = 0.0;  // not the same bits as -0.0
  CHECK(encode_trace(record) != bytes);
  CHECK(equal(decode_trace(encode_trace({})), FlightRecord{}));
}

TEST_CASE("a hundred plain steps take less than 50 bytes each") {
  FlightRecord record;
  record.pilots = {"min-height"};
  for (std::uint32_t step = 1; step <= 100; ++step)
    record.steps.push_back({step, Action::hold, -495.0 + 10 * step, 3.7, 40.0, 3, 12.3, 4.1, 4.1, 0, {}});
  CHECK(encode_trace(record).size() < 5000);
}

TEST_CASE("the bytes of a trace are pinned: digests outlive builds") {
  FlightRecord record;
  record.pilots = {"a"};
  record.steps.push_back({1, Action::up, 1.0, 0.0, 50.0, 2, 3.0, 4.0, 4.0, 0, {}});
  // Computed by hand from the Protobuf encoding: field number << 3 | wire type, length, little-endian doubles.
  const auto packed = [](char tag, char seventh, char eighth) {
    return std::string{tag, 8} + std::string(6, '\0') + seventh + eighth;
  };
  const std::string expected = std::string("\x08\x01", 2) + "\x22\x01" + "a" + "\x32\x01\x03" +
                               packed(0x3a, '\xf0', '\x3f') + packed(0x42, '\0', '\0') + packed(0x4a, '\x49', '\x40') +
                               "\x52\x01\x04" + packed(0x5a, '\x08', '\x40') + packed(0x62, '\x10', '\x40');
  CHECK(encode_trace(record) == expected);
}

TEST_CASE("a cut or altered trace is refused, or decodes to something that is not the original") {
  const FlightRecord record = full_record();
  const std::string bytes = encode_trace(record);
  const auto taken_for_original = [&](const std::string& damaged) {
    try {
      return equal(decode_trace(damaged), record);
    } catch (const IntegrityError&) {
      return false;
    }
  };
  for (std::size_t length = 0; length < bytes.size(); ++length)
    CHECK_FALSE(taken_for_original(bytes.substr(0, length)));
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    CHECK_FALSE(taken_for_original(flipped));
  }
}

TEST_CASE("traces of another format say so") {
  std::string bytes = encode_trace(full_record());
  bytes[1] = 2;
  CHECK_THROWS_WITH(decode_trace(bytes), Catch::Contains("version 2, this program reads version 1"));
  CHECK_THROWS_AS(decode_trace("not a trace"), IntegrityError);
  CHECK_THROWS_AS(decode_trace(""), IntegrityError);
}
