#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/summary.hpp"

namespace aloft::store {

/// Position of a flight in canonical order. std::logic_error if the experiment has no such flight.
[[nodiscard]] std::int64_t flight_id(const experiment::Experiment& experiment, const experiment::FlightKey& key);

/// Tables `flight` and `trace` of an open result database. Columns are found by name: a database can lack those of
/// newer metrics, which are then computed from the traces, and can have some that this program does not know. The seal
/// of a row covers all its columns. Throws SQLite::Exception, and IntegrityError for rows that were altered.
class FlightTable {
 public:
  /// The arguments must outlive it.
  FlightTable(SQLite::Database& database, const std::filesystem::path& file, const experiment::Experiment& experiment)
      : database_(database), file_(file), experiment_(experiment) {}

  /// Gives the database of an older Aloft the columns of newer metrics; InputError if a newer one wrote it. Call it
  /// inside a transaction, before the first insert.
  void add_missing_columns();
  void insert(const experiment::FlightSummary& flight, std::string_view trace);

  /// SHA-256 of the trace; nullopt if this flight is not stored.
  [[nodiscard]] std::optional<std::string> digest(const experiment::FlightKey& key);
  /// At most `limit` flights (-1: all) from this id on, in canonical order. Returns the last id; nullopt if there was
  /// no flight.
  std::optional<std::int64_t> visit(std::int64_t from, std::int64_t limit,
                                    const std::function<void(experiment::FlightSummary)>& visit) const;
  /// The encoded trace; nullopt if this flight is not stored.
  [[nodiscard]] std::optional<std::string> trace(const experiment::FlightKey& key) const;

  /// All metrics of a flight. IntegrityError if the trace cannot be decoded or has no steps.
  [[nodiscard]] flight::MetricValues measure(std::uint32_t condition, std::string_view trace) const;

 private:
  class Row;

  [[nodiscard]] experiment::FlightSummary summary_of(const Row& row) const;
  [[nodiscard]] std::string trace_with(std::int64_t id, const std::string& digest) const;

  SQLite::Database& database_;
  const std::filesystem::path& file_;
  const experiment::Experiment& experiment_;
  // Prepared once, because every stored flight needs them.
  std::vector<std::string> columns_;
  std::unique_ptr<SQLite::Statement> find_digest_;
  std::unique_ptr<SQLite::Statement> insert_flight_;
  std::unique_ptr<SQLite::Statement> insert_trace_;
};

}  // namespace aloft::store
