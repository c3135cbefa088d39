#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/flight/flight.hpp"

namespace aloft::store {

/// One stored flight without its steps.
struct FlightSummary {
  experiment::FlightKey key;
  double qos_mean = 0.0;
  double height_mean_m = 0.0;
  std::uint32_t height_changes = 0;
  std::string digest;  ///< SHA-256 of the encoded trace
};

/// The trace as Protobuf (idl/trace.proto), the same bytes for the same record. These bytes are stored, hashed and
/// sent.
[[nodiscard]] std::string encode_trace(const flight::FlightRecord& record);
/// Throws IntegrityError.
[[nodiscard]] flight::FlightRecord decode_trace(std::string_view bytes);

enum class Stored : std::uint8_t { added, already_there };

/// results.sqlite: every finished flight under (condition, trial, agent). One writer, any number of readers.
class ResultStore {
 public:
  /// Creates or opens DIR/results.sqlite for this experiment. InputError if DIR holds another experiment's results (the
  /// message names the first difference) or cannot be written; IntegrityError with a hint if the database is corrupt.
  static ResultStore open_for_writing(const std::filesystem::path& dir, const experiment::Experiment& experiment);
  /// Opens an existing result folder, read only.
  static ResultStore open_for_reading(const std::filesystem::path& dir);

  ResultStore(ResultStore&&) noexcept;
  ~ResultStore();

  /// The experiment whose results these are.
  [[nodiscard]] const experiment::Experiment& experiment() const noexcept;

  /// Storing is idempotent; a second record of the same flight with another digest throws IntegrityError. Durable once
  /// it returns, unless a batch is open.
  Stored add(const experiment::FlightKey& key, std::string_view encoded_trace);
  /// Everything added inside `work` becomes durable together.
  void batch(const std::function<void()>& work);

  [[nodiscard]] std::set<experiment::FlightKey> keys() const;
  /// Canonical order: condition, trial, then the experiment's order of agents.
  [[nodiscard]] std::vector<FlightSummary> flights() const;
  /// The encoded trace; throws IntegrityError if its digest does not match.
  [[nodiscard]] std::string trace(const experiment::FlightKey& key) const;

  /// One SHA-256 over all flights in canonical order.
  [[nodiscard]] std::string digest() const;

 private:
  struct State;
  explicit ResultStore(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace aloft::store
