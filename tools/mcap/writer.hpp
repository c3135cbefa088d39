#pragma once

#include <boost/crc.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aloft::mcap {

/// Writes a recording of timed messages in the MCAP format (https://mcap.dev/spec), with all of its indexes, statistics
/// and checksums. Messages lie in chunks without compression. The same calls give the same bytes. What exceeds the
/// format is a std::length_error.
class Writer {
 public:
  /// Takes the file's bytes, in order.
  using Sink = std::function<void(std::string_view)>;

  /// `library`: the program that writes, for people.
  Writer(Sink sink, std::string_view library);

  /// What messages look like. `encoding`, `data`: as in the format's registry, e.g. "protobuf" with a serialised
  /// FileDescriptorSet. Returns its number in the file.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  /// A stream of messages of one schema. Returns its number in the file.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding);
  /// Facts about the recording.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& facts);
  /// A message of a channel, `time_ns` after the recording's time 0. Readers are fastest if messages come in their
  /// order in time.
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view data);
  /// Ends the file; nothing can be written after that.
  void finish();

 private:
  /// From the earliest to the latest message.
  struct Times {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    bool any = false;

    void add(std::uint64_t time_ns);
  };
  struct Placed {
    std::uint64_t time_ns;
    std::uint64_t offset;  // in the chunk
  };

  void emit(std::string_view bytes);
  void emit_record(std::uint8_t opcode, std::string_view content);
  void close_chunk();
  [[nodiscard]] std::string statistics() const;

  Sink sink_;
  std::uint64_t offset_ = 0;     // of the next byte of the file
  boost::crc_32_type data_crc_;  // of all bytes so far

  std::string chunk_;  // records of the open chunk
  Times chunk_times_;
  std::map<std::uint16_t, std::vector<Placed>> chunk_messages_;  // by channel

  // Records that the summary repeats or adds, by kind.
  std::string schemas_;
  std::string channels_;
  std::string chunk_indexes_;
  std::string metadata_indexes_;

  std::uint16_t schema_count_ = 0;
  std::uint32_t metadata_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  Times times_;
  std::map<std::uint16_t, std::uint64_t> message_counts_;  // by channel
};

}  // namespace aloft::mcap
