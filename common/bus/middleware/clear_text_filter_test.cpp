// What a process of a secured run accepts.
#include "common/bus/middleware/clear_text_filter.hpp"

#include <catch2/catch.hpp>
#include <vector>

using aloft::bus::permitted_in_secured_run;

namespace {

using Bytes = std::vector<unsigned char>;

/// Whether a message of these submessages, from any sender, is permitted.
bool permitted(std::initializer_list<Bytes> submessages) {
  Bytes message{'R', 'T', 'P', 'S', 2, 2, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  for (const Bytes& submessage : submessages) message.insert(message.end(), submessage.begin(), submessage.end());
  return permitted_in_secured_run(message.data(), message.size());
}

/// A DATA submessage with eight bytes of content.
Bytes data(unsigned writer, bool last = false, bool little_endian = true, unsigned kind = 0x15) {
  const auto length = static_cast<unsigned char>(last ? 0 : 28);
  Bytes bytes{static_cast<unsigned char>(kind), static_cast<unsigned char>(little_endian ? 5 : 4), 0, 0, 0, 0, 16, 0};
  bytes[little_endian ? 2 : 3] = length;
  bytes.insert(bytes.end(), 4, 0);
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes.push_back(static_cast<unsigned char>(writer >> shift));
  bytes.insert(bytes.end(), 16, 0);
  return bytes;
}

const Bytes time_stamp{0x09, 1, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};
const Bytes no_time_stamp{0x09, 3, 0, 0};
const Bytes encrypted{0x31, 1, 4, 0, 9, 9, 9, 9, 0x30, 1, 3, 0, 9, 9, 9, 0, 0x32, 1, 4, 0, 9, 9, 9, 9};
constexpr unsigned announcement = 0x000100c2;
constexpr unsigned handshake = 0x000201c3;
constexpr unsigned of_a_user = 0x00000102;

}  // namespace

TEST_CASE("introductions and what is encrypted are permitted") {
  CHECK(permitted({}));
  CHECK(permitted({time_stamp, data(announcement)}));
  CHECK(permitted({no_time_stamp, data(handshake, true)}));
  CHECK(permitted({data(announcement, false, false)}));
  CHECK(permitted({time_stamp, encrypted, encrypted, time_stamp, encrypted}));
}

TEST_CASE("clear text is not permitted at any place in a message") {
  CHECK_FALSE(permitted({data(of_a_user)}));
  CHECK_FALSE(permitted({data(of_a_user, true)}));
  CHECK_FALSE(permitted({data(of_a_user, false, false)}));
  CHECK_FALSE(permitted({data(of_a_user, false, true, 0x16)}));
  for (const unsigned builtin : {0x000003c2U, 0x000004c2U, 0x000200c2U, 0xff0003c2U, 0xff0202c3U})
    CHECK_FALSE(permitted({data(builtin)}));
  CHECK_FALSE(permitted({time_stamp, data(announcement), data(of_a_user)}));
  CHECK_FALSE(permitted({encrypted, data(of_a_user)}));
  CHECK_FALSE(permitted({no_time_stamp, data(of_a_user)}));
  // INFO_SRC, which changes the sender; SRTPS_PREFIX, one key for all messages of a process; then forged
  // acknowledgements, heartbeats and gaps.
  CHECK_FALSE(permitted({Bytes{0x0c, 1, 4, 0, 0, 0, 0, 0}, encrypted}));
  CHECK_FALSE(permitted({Bytes{0x33, 1, 4, 0, 9, 9, 9, 9}}));
  for (const unsigned char kind : Bytes{0x06, 0x07, 0x08, 0x12, 0x13})
    CHECK_FALSE(permitted({Bytes{kind, 1, 8, 0, 0, 0, 0, 0, 0, 0, 1, 2}}));
}

TEST_CASE("what cannot be read to its end is not permitted") {
  CHECK_FALSE(permitted({Bytes{0x09, 1}}));
  CHECK_FALSE(permitted({Bytes{0x09, 1, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8}}));
  CHECK_FALSE(permitted({Bytes{0x15, 1, 4, 0, 0, 0, 16, 0}}));
}
