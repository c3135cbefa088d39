#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/flight/metrics.hpp"

namespace aloft::store {

inline constexpr const char* database_name = "results.sqlite";
inline constexpr const char* log_folder = "log";

enum class Access : std::uint8_t { read, write };

/// Opens (writing: or creates) a result database and checks its structure, and that no row was removed. Throws
/// InputError if it is not ours or cannot be opened, IntegrityError with a hint if it is damaged.
[[nodiscard]] std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& file, Access access);

/// The SQL that makes the tables of a new database; comments tell what each table and column holds.
[[nodiscard]] std::string database_schema();
/// Of that structure: 3, or 4 with metrics that Aloft 0.2.0 does not know.
[[nodiscard]] int database_version();
/// A column of table `flight` in SQL: "energy_j REAL NOT NULL".
[[nodiscard]] std::string column_of(const flight::Metric& metric);

/// Brings a database that an older Aloft wrote to today's format, but for the columns of table `flight`. Call it inside
/// a transaction.
void update_format(SQLite::Database& database);

/// True if its file was moved or removed since it was opened.
[[nodiscard]] bool has_moved(SQLite::Database& database);

/// Throws like open_database.
[[nodiscard]] std::int64_t count_flights(const std::filesystem::path& file);

/// Turns what SQLite reports into our errors: IntegrityError, StoreFull, InputError, or std::runtime_error.
[[noreturn]] void rethrow(const SQLite::Exception& error, const std::filesystem::path& file);

/// What to do about a damaged database; `what` is wrong with it.
[[noreturn]] void refuse_damaged(const std::filesystem::path& file, std::string_view what);

/// Runs `work` with rethrow.
template <typename Work>
decltype(auto) with_errors_of(const std::filesystem::path& file, Work&& work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    rethrow(error, file);
  }
}

/// Only one process may write into a result folder; readers do not care. Held until destroyed, or the process dies.
class WriterLock {
 public:
  /// Throws InputError if another process holds it.
  explicit WriterLock(const std::filesystem::path& dir);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  int fd_;
};

}  // namespace aloft::store
