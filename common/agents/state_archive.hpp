#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/base/parameters.hpp"

namespace aloft::agents {

/// Collects an agent's memory as named arrays: what Agent::save_state returns (Protobuf, idl/agent_state.proto, sealed
/// with a SHA-256). Equal content gives equal bytes.
class StateWriter {
 public:
  StateWriter(std::string_view agent_type, const Parameters& parameters);
  ~StateWriter();
  StateWriter(const StateWriter&) = delete;
  StateWriter& operator=(const StateWriter&) = delete;

  /// Names are unique within one state (std::logic_error).
  void put(std::string_view name, std::span<const double> values);
  void put(std::string_view name, std::span<const float> values);
  void put(std::string_view name, std::span<const std::int64_t> values);
  void put_number(std::string_view name, double value);
  void put_integer(std::string_view name, std::uint64_t value);

  /// The sealed bytes of everything put so far.
  [[nodiscard]] std::string bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the bytes of a StateWriter. Throws IntegrityError with the reason if they are truncated, altered, of another
/// agent or other parameters, or if a field is missing or has another size.
class StateReader {
 public:
  StateReader(std::string_view bytes, std::string_view agent_type, const Parameters& parameters);
  ~StateReader();
  StateReader(const StateReader&) = delete;
  StateReader& operator=(const StateReader&) = delete;

  /// The stored values, valid as long as this reader.
  [[nodiscard]] std::span<const double> doubles(std::string_view name) const;
  [[nodiscard]] std::span<const float> floats(std::string_view name) const;
  [[nodiscard]] std::span<const std::int64_t> integers(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] std::uint64_t integer(std::string_view name) const;

  /// Copies a field into memory of exactly its size.
  void get(std::string_view name, std::span<double> values) const;
  void get(std::string_view name, std::span<float> values) const;
  void get(std::string_view name, std::span<std::int64_t> values) const;

  /// Throws an IntegrityError about this state, for the agent's own checks ("replay.size is 200, allowed 0 to 100").
  [[noreturn]] void refuse(std::string_view reason) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aloft::agents
