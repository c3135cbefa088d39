#include "tools/export/event_file.hpp"

#include <tools/export/tensorboard.pb.h>

#include <bit>
#include <boost/crc.hpp>

namespace aloft::exports {
namespace {

/// Little-endian.
template <typename Unsigned>
std::string packed(Unsigned value) {
  std::string bytes;
  for (std::size_t byte = 0; byte < sizeof(Unsigned); ++byte)
    bytes += static_cast<char>((std::uint64_t{value} >> (8U * byte)) & 0xFFU);
  return bytes;
}

/// CRC-32C (Castagnoli), rotated and shifted so that a record of records has no checksum of a checksum.
std::string checksum(std::string_view bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  constexpr std::uint32_t offset = 0xA282EAD8;
  return packed(std::rotr(static_cast<std::uint32_t>(crc.checksum()), 15) + offset);
}

}  // namespace

EventFile::EventFile() {
  tensorflow::Event first;
  first.set_file_version("brain.Event:2");
  add_record(first.SerializeAsString());
}

void EventFile::add(double time_s, std::int64_t step, const Scalars& scalars) {
  tensorflow::Event event;
  event.set_wall_time(time_s);
  event.set_step(step);
  for (const auto& [name, value] : scalars) {
    tensorflow::Summary::Value& entry = *event.mutable_summary()->add_value();
    entry.set_tag(name);
    entry.set_simple_value(static_cast<float>(value));
  }
  add_record(event.SerializeAsString());
}

void EventFile::add_record(std::string_view content) {
  const std::string length = packed(std::uint64_t{content.size()});
  bytes_ += length;
  bytes_ += checksum(length);
  bytes_ += content;
  bytes_ += checksum(content);
}

}  // namespace aloft::exports
