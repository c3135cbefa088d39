#include "common/store/flight_table.hpp"

#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <variant>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/store/database.hpp"
#include "common/store/result_store.hpp"

namespace aloft::store {
namespace {

using experiment::Experiment;
using experiment::FlightKey;
using Names = std::vector<std::string>;
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

constexpr std::array<std::string_view, 6> other_columns{"id", "condition", "trial", "agent", "digest", "seal"};

/// The names of the columns, in the order of the table.
Names columns_of(SQLite::Database& database) {
  Names names;
  SQLite::Statement rows(database, "SELECT name FROM pragma_table_info('flight') ORDER BY cid");
  while (rows.executeStep()) names.push_back(rows.getColumn(0).getString());
  return names;
}

bool has(const Names& columns, std::string_view name) {
  return std::ranges::find(columns, name) != columns.end();
}

/// "?1, ?2, ?3"; the first column is the id.
std::string places(std::size_t count) {
  std::string text;
  for (std::size_t i = 1; i <= count; ++i) text += fmt::format("{}?{}", i == 1 ? "" : ", ", i);
  return text;
}

Value value_of(const SQLite::Column& column) {
  if (column.isNull()) return {};
  if (column.isInteger()) return column.getInt64();
  if (column.isFloat()) return column.getDouble();
  return column.getString();
}

/// The text by which a value enters the seal.
std::string sealed_text(const Value& value) {
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", std::bit_cast<std::uint64_t>(*real));
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return "-1";
}

Value as_stored(const flight::Metric& metric, const std::optional<double>& value) {
  if (!value) return {};
  if (metric.integer) return static_cast<std::int64_t>(*value);
  return *value;
}

std::optional<double> as_number(const Value& value) {
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::nullopt;
}

}  // namespace

/// One row of table `flight`.
class FlightTable::Row {
 public:
  Row(Names columns, const std::filesystem::path& file)
      : columns_(std::move(columns)), values_(columns_.size()), file_(file) {}

  /// A sealed row.
  Row(Names columns, const std::filesystem::path& file, std::int64_t id, const FlightSummary& flight)
      : Row(std::move(columns), file) {
    at("id") = id;
    at("condition") = std::int64_t{flight.key.condition};
    at("trial") = std::int64_t{flight.key.trial};
    at("agent") = flight.key.agent;
    at("digest") = flight.digest;
    for (std::size_t i = 0; i < flight::metrics().size(); ++i)
      at(flight::metrics()[i].key) = as_stored(flight::metrics()[i], flight.metrics[i]);
    at("seal") = seal();
  }

  [[nodiscard]] const Names& columns() const noexcept { return columns_; }
  [[nodiscard]] bool has(std::string_view column) const { return store::has(columns_, column); }

  [[nodiscard]] Value& at(std::string_view column) { return values_[index(column)]; }
  [[nodiscard]] const Value& at(std::string_view column) const { return values_[index(column)]; }

  template <typename Type>
  [[nodiscard]] const Type& get(std::string_view column) const {
    const auto* value = std::get_if<Type>(&at(column));
    if (value == nullptr)
      refuse_damaged(file_, fmt::format("column {} of table flight holds a value of another type", column));
    return *value;
  }

  /// The hash over all other columns, in the order of the table.
  [[nodiscard]] std::int64_t seal() const {
    std::string text;
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (columns_[i] != "seal") text += (text.empty() ? "" : " ") + sealed_text(values_[i]);
    return std::bit_cast<std::int64_t>(sha256_id(text));
  }

  void read(SQLite::Statement& from) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = value_of(from.getColumn(static_cast<int>(i)));
    if (seal() != get<std::int64_t>("seal"))
      refuse_damaged(file_, fmt::format("row {} of table flight was altered", get<std::int64_t>("id")));
  }

  void execute(SQLite::Statement& statement) const {
    statement.reset();
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const int place = static_cast<int>(i) + 1;
      std::visit(
          [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>)
              statement.bind(place);
            else
              statement.bind(place, value);
          },
          values_[i]);
    }
    statement.exec();
  }

 private:
  [[nodiscard]] std::size_t index(std::string_view column) const {
    const auto found = std::ranges::find(columns_, column);
    if (found == columns_.end()) refuse_damaged(file_, fmt::format("table flight has no column {}", column));
    return static_cast<std::size_t>(found - columns_.begin());
  }

  Names columns_;
  std::vector<Value> values_;
  const std::filesystem::path& file_;
};

std::int64_t flight_id(const Experiment& experiment, const FlightKey& key) {
  const std::size_t agent = experiment.agent_index(key.agent);
  const std::size_t agents = experiment.agents.size();
  if (key.condition >= experiment.conditions.size() || key.trial >= experiment.trials || agent == agents)
    throw std::logic_error(fmt::format("experiment '{}' has no flight (condition {}, trial {}, agent '{}')",
                                       experiment.name, key.condition, key.trial, key.agent));
  const std::uint64_t trial = std::uint64_t{key.condition} * experiment.trials + key.trial;
  return static_cast<std::int64_t>(trial * agents + agent);
}

void FlightTable::add_missing_columns() {
  columns_ = columns_of(database_);
  for (const std::string& column : columns_)
    if (std::ranges::find(other_columns, column) == other_columns.end() &&
        std::ranges::find(flight::metrics(), column, &flight::Metric::key) == flight::metrics().end())
      throw InputError(
          "'{}' was written by a newer Aloft, which also stores '{}' of every flight; go on with that one, "
          "or use another folder",
          file_.string(), column);
  std::vector<FlightSummary> flights;
  for (const flight::Metric& metric : flight::metrics()) {
    if (has(columns_, metric.key)) continue;
    if (flights.empty())
      visit(std::numeric_limits<std::int64_t>::min(), -1,
            [&](FlightSummary flight) { flights.push_back(std::move(flight)); });
    database_.exec(
        fmt::format("ALTER TABLE flight ADD COLUMN {}{}", column_of(metric), metric.optional ? "" : " DEFAULT 0"));
    columns_.emplace_back(metric.key);
  }
  if (flights.empty()) return;
  SQLite::Statement complete(database_, fmt::format("UPDATE flight SET ({}) = ({}) WHERE id = ?1",
                                                    fmt::join(columns_, ", "), places(columns_.size())));
  for (const FlightSummary& flight : flights)
    Row(columns_, file_, flight_id(experiment_, flight.key), flight).execute(complete);
}

void FlightTable::insert(const FlightSummary& flight, std::string_view trace) {
  if (!insert_flight_) {
    insert_flight_ = std::make_unique<SQLite::Statement>(
        database_,
        fmt::format("INSERT INTO flight ({}) VALUES ({})", fmt::join(columns_, ", "), places(columns_.size())));
    insert_trace_ = std::make_unique<SQLite::Statement>(database_, "INSERT INTO trace (flight, bytes) VALUES (?, ?)");
  }
  const std::int64_t id = flight_id(experiment_, flight.key);
  Row(columns_, file_, id, flight).execute(*insert_flight_);
  insert_trace_->reset();
  insert_trace_->bind(1, id);
  insert_trace_->bindNoCopy(2, trace.data(), static_cast<int>(trace.size()));
  insert_trace_->exec();
}

std::optional<std::string> FlightTable::digest(const FlightKey& key) {
  const std::int64_t id = flight_id(experiment_, key);
  if (!find_digest_)
    find_digest_ = std::make_unique<SQLite::Statement>(database_, "SELECT digest FROM flight WHERE id = ?");
  find_digest_->reset();
  find_digest_->bind(1, id);
  std::optional<std::string> digest;
  if (find_digest_->executeStep()) digest = find_digest_->getColumn(0).getString();
  find_digest_->reset();
  return digest;
}

std::optional<std::int64_t> FlightTable::visit(std::int64_t from, std::int64_t limit,
                                               const std::function<void(FlightSummary)>& visit) const {
  // While this statement is open, all reads see one snapshot: another process may be adding columns.
  SQLite::Statement moment(database_, "SELECT 1 FROM sqlite_master");
  (void)moment.executeStep();
  Row row(columns_of(database_), file_);
  SQLite::Statement rows(database_, fmt::format("SELECT {} FROM flight WHERE id >= ? ORDER BY id LIMIT ?",
                                                fmt::join(row.columns(), ", ")));
  SQLite::bind(rows, from, limit);
  std::optional<std::int64_t> last;
  while (rows.executeStep()) {
    row.read(rows);
    visit(summary_of(row));
    last = row.get<std::int64_t>("id");
  }
  return last;
}

std::optional<std::string> FlightTable::trace(const FlightKey& key) const {
  const std::int64_t id = flight_id(experiment_, key);
  std::optional<std::string> bytes;
  visit(id, 1, [&](const FlightSummary& flight) {
    if (flight.key == key) bytes = trace_with(id, flight.digest);
  });
  return bytes;
}

flight::MetricValues FlightTable::measure(std::uint32_t condition, std::string_view trace) const {
  return flight::measure(decode_trace(trace), experiment_.costs_in(experiment_.conditions.at(condition)));
}

FlightSummary FlightTable::summary_of(const Row& row) const {
  FlightSummary flight{{static_cast<std::uint32_t>(row.get<std::int64_t>("condition")),
                        static_cast<std::uint32_t>(row.get<std::int64_t>("trial")), row.get<std::string>("agent")},
                       {},
                       row.get<std::string>("digest")};
  std::optional<flight::MetricValues> measured;
  for (std::size_t i = 0; i < flight::metrics().size(); ++i) {
    const std::string_view column = flight::metrics()[i].key;
    if (row.has(column)) {
      flight.metrics[i] = as_number(row.at(column));
      continue;
    }
    if (!measured) measured = measure(flight.key.condition, trace_with(row.get<std::int64_t>("id"), flight.digest));
    flight.metrics[i] = (*measured)[i];
  }
  return flight;
}

std::string FlightTable::trace_with(std::int64_t id, const std::string& digest) const {
  SQLite::Statement query(database_, "SELECT bytes FROM trace WHERE flight = ?");
  query.bind(1, id);
  std::string bytes = query.executeStep() ? query.getColumn(0).getString() : "";
  if (sha256_hex(bytes) != digest) refuse_damaged(file_, fmt::format("row {} of table trace was altered", id));
  return bytes;
}

}  // namespace aloft::store
