#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/base/descriptor.hpp"
#include "common/flight/metrics.hpp"

namespace aloft::store {

inline constexpr const char* database_name = "results.sqlite";
inline constexpr const char* log_folder = "log";

enum class Access : std::uint8_t { read, write };

/// Opens (writing: or creates) a result database and checks its structure, and that no row was removed. Throws
/// InputError if it is not of Aloft or cannot be opened, IntegrityError with a hint if it is damaged.
[[nodiscard]] std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& file, Access access);

/// The SQL that makes the tables of a new database; comments tell what each table and column holds.
[[nodiscard]] std::string database_schema();
/// The number of that format: 3, or 4 with metrics that Aloft 0.2.0 does not know.
[[nodiscard]] int database_version();
/// A column of table `flight` in SQL: "energy_j REAL NOT NULL".
[[nodiscard]] std::string column_of(const flight::Metric& metric);

/// Brings a database that an older Aloft wrote to the present format, except the columns of table `flight` (see
/// FlightTable::add_missing_columns). Call it inside a transaction.
void update_format(SQLite::Database& database);

/// True if its file was moved or removed since it was opened.
[[nodiscard]] bool has_moved(SQLite::Database& database);

/// Throws like open_database.
[[nodiscard]] std::int64_t count_flights(const std::filesystem::path& file);

/// Throws the error of Aloft for an error of SQLite: IntegrityError, StoreFull, InputError, or std::runtime_error.
[[noreturn]] void rethrow(const SQLite::Exception& error, const std::filesystem::path& file);

/// Throws IntegrityError: `what` is wrong with the database, and what to do about it.
[[noreturn]] void refuse_damaged(const std::filesystem::path& file, std::string_view what);

/// Runs `work`; errors of SQLite become those of rethrow().
template <typename Work>
decltype(auto) with_errors_of(const std::filesystem::path& file, Work&& work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    rethrow(error, file);
  }
}

/// Lets only one process at a time write into a result folder; readers need no lock. Held until the descriptor is
/// closed or the process ends. InputError if another process holds it.
[[nodiscard]] Descriptor lock_for_writing(const std::filesystem::path& dir);

}  // namespace aloft::store
