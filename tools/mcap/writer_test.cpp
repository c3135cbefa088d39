#include "tools/mcap/writer.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>
#include <string>

using aloft::mcap::Writer;

namespace {

std::string hex_of(std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string hex;
  for (const char byte : bytes) {
    hex += digits[static_cast<unsigned char>(byte) >> 4U];
    hex += digits[static_cast<unsigned char>(byte) & 15U];
  }
  return hex;
}

Writer::Sink into(std::string& file) {
  return [&file](std::string_view bytes) { file += bytes; };
}

}  // namespace

// Packed by a Python program from the tables of the specification, with the checksums of its zlib.
TEST_CASE("a recording of one message has the bytes of the format") {
  std::string file;
  Writer writer(into(file), "w");
  writer.add_metadata("m", {{"k", "v"}});
  const std::uint16_t schema = writer.add_schema("S", "jsonschema", "{}");
  const std::uint16_t channel = writer.add_channel(schema, "/t", "json");
  writer.write(channel, 5, "[]");
  writer.finish();

  const std::string magic = "894d434150300d0a";
  const std::string header = "010900000000000000000000000100000077";
  const std::string metadata = "0c1300000000000000010000006d0a000000010000006b0100000076";
  const std::string chunk =
      "068c00000000000000050000000000000005000000000000006400000000000000e5e9d1b8000000006400000000000000";
  const std::string schema_record = "031b00000000000000010001000000530a0000006a736f6e736368656d61020000007b7d";
  const std::string channel_record = "04160000000000000000000100020000002f74040000006a736f6e00000000";
  const std::string message = "051800000000000000000000000000050000000000000005000000000000005b5d";
  const std::string message_index = "07160000000000000000001000000005000000000000004300000000000000";
  const std::string data_end = "0f0400000000000000e2960ddc";
  const std::string statistics =
      "0b3800000000000000010000000000000001000100000000000000010000000100000005000000000000000500000000000000"
      "0a00000000000100000000000000";
  const std::string chunk_index =
      "084a0000000000000005000000000000000500000000000000360000000000000095000000000000000a0000000000cb00000000000000"
      "1f000000000000000000000064000000000000006400000000000000";
  const std::string metadata_index = "0d15000000000000001a000000000000001c00000000000000010000006d";
  const std::string summary_offsets =
      "0e110000000000000003f7000000000000002400000000000000"
      "0e1100000000000000041b010000000000001f00000000000000"
      "0e11000000000000000b3a010000000000004100000000000000"
      "0e1100000000000000087b010000000000005300000000000000"
      "0e11000000000000000dce010000000000001e00000000000000";
  const std::string footer = "021400000000000000f700000000000000ec010000000000005bf2f5b0";
  CHECK(hex_of(file) == magic + header + metadata + chunk + schema_record + channel_record + message + message_index +
                            data_end + schema_record + channel_record + statistics + chunk_index + metadata_index +
                            summary_offsets + footer + magic);
}

TEST_CASE("a chunk ends at 1 MiB") {
  std::string file;
  Writer writer(into(file), "w");
  const std::uint16_t channel = writer.add_channel(writer.add_schema("S", "", ""), "/t", "");
  writer.write(channel, 0, std::string(500'000, 'x'));
  const std::size_t before = file.size();
  writer.write(channel, 1, std::string(500'000, 'x'));
  CHECK(file.size() == before);
  writer.write(channel, 2, std::string(500'000, 'x'));
  CHECK(file.size() > 1'500'000);
}

TEST_CASE("messages of channels that there are not are refused") {
  std::string file;
  Writer writer(into(file), "w");
  CHECK_THROWS_AS(writer.write(0, 0, ""), std::out_of_range);
}
