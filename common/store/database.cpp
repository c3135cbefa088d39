#include "common/store/database.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"

namespace aloft::store {
namespace {

constexpr int application_id = 0x416C6F66;  // "Alof"; `file results.sqlite` shows it
constexpr int version_without_tally = 2;
constexpr int version_of_0_2_0 = 3;
constexpr int version_with_later_metrics = 4;
constexpr int busy_timeout_ms = 5000;
constexpr std::uintmax_t no_room_bytes = 1U << 20U;

// The comments are kept in the database, and docs/reference/database.md is made from them.
// Flights have one order, `id`, and no second index that could disagree with it. `seal` is there because SQLite does
// not notice a changed number.
constexpr std::string_view schema = R"(
CREATE TABLE experiment (  -- What was flown: one row.
  one INTEGER PRIMARY KEY CHECK (one = 1),  -- Always 1.
  id TEXT NOT NULL,  -- Experiment id: a hash of all that can change a result.
  canonical TEXT NOT NULL,  -- The resolved experiment as JSON, every default filled in.
  canonical_sha256 TEXT NOT NULL,  -- Its SHA-256.
  build TEXT NOT NULL  -- Version, commit and compiler of the program that began the folder.
) STRICT;
CREATE TABLE flight (  -- One row per stored flight.
  id INTEGER PRIMARY KEY,  -- (condition * trials + trial) * agents + agent, the agent by its place in the experiment: canonical order.
  condition INTEGER NOT NULL,  -- From 0, in the order of the sweep.
  trial INTEGER NOT NULL,  -- From 0.
  agent TEXT NOT NULL,  -- Its name in the experiment.
{}  digest TEXT NOT NULL,  -- SHA-256 of the trace.
  seal INTEGER NOT NULL  -- Hash of the rest of the row: a changed number is noticed.
) STRICT;
CREATE TABLE trace (  -- The steps of every flight.
  flight INTEGER PRIMARY KEY,  -- flight.id
  bytes BLOB NOT NULL  -- Protobuf, message Trace of idl/trace.proto.
) STRICT;
)";

// Aloft never removes a flight, so a missing row was removed by another program.
constexpr std::string_view tally_schema = R"(
CREATE TABLE tally (  -- How many flights were ever stored; a trigger counts them.
  one INTEGER PRIMARY KEY CHECK (one = 1),  -- Always 1.
  flights INTEGER NOT NULL  -- As many as table flight has rows, unless some were removed.
) STRICT;
)";
constexpr const char* tally_counting = R"(
INSERT INTO tally SELECT 1, count(*) FROM flight;
CREATE TRIGGER count_flights AFTER INSERT ON flight BEGIN
  UPDATE tally SET flights = flights + 1;
END;
)";

// These tables are not part of any result.
constexpr std::string_view later_schema = R"(
CREATE TABLE IF NOT EXISTS memory (  -- The memory of agents that learn over several flights, after the latest flight of each lineage.
  condition INTEGER NOT NULL,  -- From 0, in the order of the sweep.
  agent TEXT NOT NULL,  -- Its name in the experiment.
  lineage INTEGER NOT NULL,  -- trial modulo the agent's parameter lineages.
  trial INTEGER NOT NULL,  -- Trial of the flight after which the memory was saved.
  digest TEXT NOT NULL,  -- SHA-256 of condition, trial, agent and bytes.
  bytes BLOB NOT NULL,  -- State of the agent, Protobuf.
  PRIMARY KEY (condition, agent, lineage)
) STRICT;
CREATE TABLE IF NOT EXISTS writer (  -- Which process writes into the database: one row, by which the coordinator recognises its collector.
  one INTEGER PRIMARY KEY CHECK (one = 1),  -- Always 1.
  incarnation INTEGER NOT NULL,  -- Random, new at every start of the process.
  host TEXT NOT NULL,  -- Name of its machine.
  pid INTEGER NOT NULL,  -- Number of the process.
  since_s INTEGER NOT NULL  -- Unix time of its start.
) STRICT;
)";

int pragma(SQLite::Database& database, const char* name) {
  return database.execAndGet(fmt::format("PRAGMA {}", name)).getInt();
}

bool disk_is_full(const std::filesystem::path& file) {
  std::error_code failed;
  const auto space = std::filesystem::space(file.parent_path(), failed);
  return !failed && space.available < no_room_bytes;
}

void create_schema(SQLite::Database& database) {
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  database.exec(database_schema());
  database.exec(tally_counting);
  database.exec(fmt::format("PRAGMA application_id = {}", application_id));
  database.exec(fmt::format("PRAGMA user_version = {}", database_version()));
  transaction.commit();
}

/// The lines of the schema for the metrics: those of Aloft 0.2.0 in the order of that version, then the others.
std::string metric_columns() {
  std::vector<flight::Metric> metrics(flight::metrics().begin(), flight::metrics().end());
  const auto place = [](const flight::Metric& metric) {
    return metric.format_3_place.value_or(std::numeric_limits<int>::max());
  };
  std::ranges::stable_sort(metrics, {}, place);
  std::string text;
  for (const flight::Metric& metric : metrics)
    text += fmt::format("  {},  -- {}\n", column_of(metric), metric.description);
  return text;
}

void check_identity(SQLite::Database& database, const std::filesystem::path& file) {
  if (pragma(database, "application_id") != application_id)
    throw InputError("'{}' is a database of another program; use another folder", file.string());
  if (const int version = pragma(database, "user_version");
      version < version_without_tally || version > version_with_later_metrics)
    throw InputError(
        "'{}' has format {}, this program reads format {}; use the version of Aloft that wrote it, or "
        "another folder",
        file.string(), version, database_version());
}

void check_structure(SQLite::Database& database, const std::filesystem::path& file) {
  const std::string found = database.execAndGet("PRAGMA quick_check(1)").getString();
  if (found != "ok") refuse_damaged(file, found);
}

/// Without this check, flights whose rows were removed would look as if never flown. Each statement sees one snapshot:
/// another process may be writing.
void check_rows(SQLite::Database& database, const std::filesystem::path& file) {
  SQLite::Statement traceless(database,
                              "SELECT flight.id FROM flight LEFT JOIN trace ON trace.flight = flight.id "
                              "WHERE trace.flight IS NULL LIMIT 1");
  if (traceless.executeStep())
    refuse_damaged(file,
                   fmt::format("the trace of row {} of table flight was removed", traceless.getColumn(0).getInt64()));
  const bool has_tally = pragma(database, "user_version") != version_without_tally;
  SQLite::Statement counts(database,
                           fmt::format("SELECT (SELECT count(*) FROM experiment), (SELECT count(*) FROM flight), "
                                       "(SELECT count(*) FROM trace), {}",
                                       has_tally ? "(SELECT flights FROM tally)" : "(SELECT count(*) FROM flight)"));
  counts.executeStep();
  const std::int64_t flights = counts.getColumn(1).getInt64();
  const std::int64_t traces = counts.getColumn(2).getInt64();
  const std::int64_t stored = counts.getColumn(3).getInt64();
  if (flights != stored || traces != stored)
    refuse_damaged(file,
                   fmt::format("it holds {} flights and {} traces, and {} were stored in it", flights, traces, stored));
  if (flights > 0 && counts.getColumn(0).getInt() == 0) refuse_damaged(file, "the experiment was removed from it");
}

/// WAL, so that readers never wait; FULL, so that a committed flight survives a power loss.
void set_up_writing(SQLite::Database& database) {
  database.exec("PRAGMA journal_mode = WAL");
  database.exec("PRAGMA synchronous = FULL");
  database.exec("PRAGMA wal_autocheckpoint = 4000");
}

std::unique_ptr<SQLite::Database> open_for_writing(const std::filesystem::path& file) {
  auto database =
      std::make_unique<SQLite::Database>(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms);
  const bool is_new = database->execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0 &&
                      pragma(*database, "application_id") == 0;
  if (is_new) {
    set_up_writing(*database);
    create_schema(*database);
    return database;
  }
  check_identity(*database, file);
  check_structure(*database, file);
  check_rows(*database, file);
  set_up_writing(*database);
  return database;
}

/// In a read-only folder, such as a mounted archive, SQLite cannot create the shared memory of the WAL mode. No other
/// process can write there either, so the database is opened as immutable.
std::unique_ptr<SQLite::Database> open_for_reading(const std::filesystem::path& file) {
  try {
    auto database = std::make_unique<SQLite::Database>(file.string(), SQLite::OPEN_READONLY, busy_timeout_ms);
    (void)pragma(*database, "application_id");
    return database;
  } catch (const SQLite::Exception& error) {
    const bool read_only_folder = ::access(file.parent_path().c_str(), W_OK) != 0;
    if (!read_only_folder || std::filesystem::exists(file.string() + "-wal")) throw;
    return std::make_unique<SQLite::Database>(fmt::format("file:{}?immutable=1", file.string()),
                                              SQLite::OPEN_READONLY | SQLite::OPEN_URI);
  }
}

}  // namespace

std::string database_schema() {
  return fmt::format(schema, metric_columns()) + std::string(tally_schema) + std::string(later_schema);
}

int database_version() {
  const auto& metrics = flight::metrics();
  return std::ranges::all_of(metrics, [](const flight::Metric& metric) { return metric.format_3_place.has_value(); })
             ? version_of_0_2_0
             : version_with_later_metrics;
}

std::string column_of(const flight::Metric& metric) {
  return fmt::format("{} {}{}", metric.key, metric.integer ? "INTEGER" : "REAL", metric.optional ? "" : " NOT NULL");
}

std::unique_ptr<SQLite::Database> open_database(const std::filesystem::path& file, Access access) {
  return with_errors_of(file, [&] {
    if (access == Access::write) return open_for_writing(file);
    auto database = open_for_reading(file);
    check_identity(*database, file);
    check_structure(*database, file);
    check_rows(*database, file);
    return database;
  });
}

void update_format(SQLite::Database& database) {
  if (pragma(database, "user_version") == version_without_tally) {
    database.exec(std::string(later_schema) + std::string(tally_schema));
    database.exec(tally_counting);
  }
  if (pragma(database, "user_version") != database_version())
    database.exec(fmt::format("PRAGMA user_version = {}", database_version()));
}

bool has_moved(SQLite::Database& database) {
  int moved = 0;
  return sqlite3_file_control(database.getHandle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK && moved != 0;
}

std::int64_t count_flights(const std::filesystem::path& file) {
  return with_errors_of(
      file, [&] { return open_database(file, Access::read)->execAndGet("SELECT count(*) FROM flight").getInt64(); });
}

void rethrow(const SQLite::Exception& error, const std::filesystem::path& file) {
  const int code = error.getErrorCode();
  // Our statements are correct, so a missing table or column (SQLITE_ERROR) is damage, too.
  if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB || code == SQLITE_ERROR || code == SQLITE_FORMAT)
    refuse_damaged(file, error.what());
  if (code == SQLITE_FULL || (code == SQLITE_IOERR && disk_is_full(file)))
    throw StoreFull("the disk that holds '{}' is full; make room there", file.string());
  if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY || code == SQLITE_PERM)
    throw InputError("cannot open '{}': {}; check that the folder exists and may be written", file.string(),
                     error.what());
  throw std::runtime_error(fmt::format("'{}': {}", file.string(), error.what()));
}

void refuse_damaged(const std::filesystem::path& file, std::string_view what) {
  throw IntegrityError(
      "'{}' is damaged: {}. Nothing in it is trusted. Restore the folder from a copy, or move it away and run the same "
      "command again: the same experiment gives the same results",
      file.string(), what);
}

Descriptor lock_for_writing(const std::filesystem::path& dir) {
  Descriptor folder(::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // A file system without such locks is used without protection.
  if (!folder.is_open() || ::flock(folder.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return folder;
  throw InputError(
      "'{}' is being written by another Aloft process; wait for it, stop it, or use another folder for --out",
      dir.string());
}

}  // namespace aloft::store
