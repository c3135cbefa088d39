#include "tools/mcap/writer.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace aloft::mcap {
namespace {

constexpr std::string_view magic("\x89MCAP0\r\n", 8);

/// A chunk is closed once it has this many bytes: readers load whole chunks.
constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;

enum Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema_record = 0x03,
  channel_record = 0x04,
  message = 0x05,
  chunk_record = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics_record = 0x0B,
  metadata_record = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Little-endian.
template <typename Unsigned>
void add(std::string& to, Unsigned value) {
  for (std::size_t byte = 0; byte < sizeof(Unsigned); ++byte)
    to += static_cast<char>((std::uint64_t{value} >> (8U * byte)) & 0xFFU);
}

/// With its length before it, as texts, arrays and maps have it.
void add_sized(std::string& to, std::string_view bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error("MCAP: a text, array or map of more than 4 GiB");
  add(to, static_cast<std::uint32_t>(bytes.size()));
  to += bytes;
}

void add_record(std::string& to, std::uint8_t opcode, std::string_view content) {
  add(to, opcode);
  add(to, std::uint64_t{content.size()});
  to += content;
}

std::uint32_t crc32(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace

void Writer::Times::add(std::uint64_t time_ns) {
  first_ns = any ? std::min(first_ns, time_ns) : time_ns;
  last_ns = any ? std::max(last_ns, time_ns) : time_ns;
  any = true;
}

Writer::Writer(Sink sink, std::string_view library) : sink_(std::move(sink)) {
  emit(magic);
  std::string content;
  add_sized(content, "");  // the profile: none of the registry's
  add_sized(content, library);
  emit_record(header, content);
}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding, std::string_view data) {
  if (schema_count_ == std::numeric_limits<std::uint16_t>::max()) throw std::length_error("MCAP: too many schemas");
  std::string content;
  add(content, ++schema_count_);
  add_sized(content, name);
  add_sized(content, encoding);
  add_sized(content, data);
  add_record(chunk_, schema_record, content);
  add_record(schemas_, schema_record, content);
  return schema_count_;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding) {
  if (message_counts_.size() > std::numeric_limits<std::uint16_t>::max())
    throw std::length_error("MCAP: too many channels");
  const auto id = static_cast<std::uint16_t>(message_counts_.size());
  message_counts_[id] = 0;
  std::string content;
  add(content, id);
  add(content, schema);
  add_sized(content, topic);
  add_sized(content, message_encoding);
  add_sized(content, "");  // metadata: none
  add_record(chunk_, channel_record, content);
  add_record(channels_, channel_record, content);
  return id;
}

void Writer::add_metadata(std::string_view name, const std::map<std::string, std::string>& facts) {
  close_chunk();
  std::string pairs;
  for (const auto& [key, value] : facts) {
    add_sized(pairs, key);
    add_sized(pairs, value);
  }
  std::string content;
  add_sized(content, name);
  add_sized(content, pairs);
  const std::uint64_t start = offset_;
  emit_record(metadata_record, content);
  std::string index;
  add(index, start);
  add(index, offset_ - start);
  add_sized(index, name);
  add_record(metadata_indexes_, metadata_index, index);
  ++metadata_count_;
}

void Writer::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view data) {
  const std::uint64_t sequence = message_counts_.at(channel)++;
  times_.add(time_ns);
  chunk_times_.add(time_ns);
  chunk_messages_[channel].push_back({time_ns, chunk_.size()});
  std::string content;
  add(content, channel);
  add(content, static_cast<std::uint32_t>(sequence));
  add(content, time_ns);  // recorded
  add(content, time_ns);  // published
  content += data;
  add_record(chunk_, message, content);
  if (chunk_.size() >= chunk_bytes) close_chunk();
}

void Writer::emit(std::string_view bytes) {
  data_crc_.process_bytes(bytes.data(), bytes.size());
  offset_ += bytes.size();
  sink_(bytes);
}

void Writer::emit_record(std::uint8_t opcode, std::string_view content) {
  std::string record;
  add_record(record, opcode, content);
  emit(record);
}

void Writer::close_chunk() {
  if (chunk_.empty()) return;
  std::string content;
  add(content, chunk_times_.first_ns);
  add(content, chunk_times_.last_ns);
  add(content, std::uint64_t{chunk_.size()});
  add(content, crc32(chunk_));
  add_sized(content, "");  // compression: none
  add(content, std::uint64_t{chunk_.size()});
  content += chunk_;
  const std::uint64_t start = offset_;
  emit_record(chunk_record, content);

  const std::uint64_t indexes_start = offset_;
  std::string index_offsets;
  for (const auto& [channel, messages] : chunk_messages_) {
    add(index_offsets, channel);
    add(index_offsets, offset_);
    std::string entries;
    for (const Placed& placed : messages) {
      add(entries, placed.time_ns);
      add(entries, placed.offset);
    }
    std::string index;
    add(index, channel);
    add_sized(index, entries);
    emit_record(message_index, index);
  }

  std::string index;
  add(index, chunk_times_.first_ns);
  add(index, chunk_times_.last_ns);
  add(index, start);
  add(index, indexes_start - start);
  add_sized(index, index_offsets);
  add(index, offset_ - indexes_start);
  add_sized(index, "");  // compression: none
  add(index, std::uint64_t{chunk_.size()});
  add(index, std::uint64_t{chunk_.size()});
  add_record(chunk_indexes_, chunk_index, index);
  ++chunk_count_;
  chunk_.clear();
  chunk_times_ = {};
  chunk_messages_.clear();
}

std::string Writer::statistics() const {
  std::uint64_t messages = 0;
  std::string counts;
  for (const auto& [channel, count] : message_counts_) {
    messages += count;
    add(counts, channel);
    add(counts, count);
  }
  std::string content;
  add(content, messages);
  add(content, schema_count_);
  add(content, static_cast<std::uint32_t>(message_counts_.size()));
  add(content, std::uint32_t{0});  // attachments
  add(content, metadata_count_);
  add(content, chunk_count_);
  add(content, times_.first_ns);
  add(content, times_.last_ns);
  add_sized(content, counts);
  std::string record;
  add_record(record, statistics_record, content);
  return record;
}

void Writer::finish() {
  close_chunk();
  std::string crc;
  add(crc, data_crc_.checksum());
  emit_record(data_end, crc);

  const std::uint64_t summary_start = offset_;
  const std::string statistics_text = statistics();
  std::string summary;
  std::string offsets;
  for (const std::string_view group :
       {std::string_view(schemas_), std::string_view(channels_), std::string_view(statistics_text),
        std::string_view(chunk_indexes_), std::string_view(metadata_indexes_)}) {
    if (group.empty()) continue;
    std::string place;
    add(place, static_cast<std::uint8_t>(group.front()));
    add(place, summary_start + summary.size());
    add(place, std::uint64_t{group.size()});
    add_record(offsets, summary_offset, place);
    summary += group;
  }
  const std::uint64_t offsets_start = summary_start + summary.size();
  summary += offsets;

  // The footer's checksum is of everything from the summary to where it stands itself.
  constexpr std::uint64_t footer_bytes = 8 + 8 + 4;
  add(summary, std::uint8_t{footer});
  add(summary, footer_bytes);
  add(summary, summary_start);
  add(summary, offsets_start);
  add(summary, crc32(summary));
  emit(summary);
  emit(magic);
}

}  // namespace aloft::mcap
