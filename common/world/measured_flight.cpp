#include "common/world/measured_flight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::world {
namespace {

constexpr std::size_t largest_heights = 1000;
constexpr double rounding = 1e-6;  // allowed error of spacings, relative
static_assert(largest_heights <= limits::heights);

struct Column {
  const char* name;
  bool required;
  double minimum;
  double maximum;
  bool whole;
};

enum ColumnIndex : std::size_t { step, height, throughput, sinr, latitude, longitude, serving_cell, observed, count };

constexpr std::array<Column, ColumnIndex::count> columns{{
    {"step", true, 1, limits::steps, true},
    {"height_m", true, 0, 10'000, false},
    {"throughput_kbps", true, 0, limits::quality, false},
    {"sinr_db", false, -200, 200, false},
    {"latitude", false, -90, 90, false},
    {"longitude", false, -180, 180, false},
    {"serving_cell", false, 0, 2147483647, true},
    {"observed", false, 0, 1, true},
}};

/// A field and its place in the file.
struct Field {
  std::string_view text;
  std::size_t line;
  std::size_t column;
};

/// One row's values, by ColumnIndex; 0 where the file has no such column.
struct Row {
  std::array<double, ColumnIndex::count> value{};
  Field step_field;
  Field height_field;
};

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<Field> split(std::string_view line, std::size_t line_number) {
  std::vector<Field> fields;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back({without_blanks(line.substr(begin, end - begin)), line_number, begin + 1});
    if (end == line.size()) return fields;
    begin = end + 1;
  }
}

/// Parses CSV text into rows. Messages begin with the file's name.
class Reader {
 public:
  Reader(std::string_view csv, std::string_view name) : rest_(csv), name_(name) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }

  std::vector<Row> read() {
    read_header();
    std::vector<Row> rows;
    while (const auto line = next_line()) rows.push_back(read_row(*line));
    if (rows.empty())
      throw InputError("{}:{}:1: no rows after the header; one row per (step, height) is needed", name_,
                       line_number_ + 1);
    return rows;
  }

  [[nodiscard]] bool has(ColumnIndex index) const { return std::ranges::find(order_, index) != order_.end(); }

  [[noreturn]] void fail(const Field& at, const std::string& reason) const {
    throw InputError("{}:{}:{}: {}", name_, at.line, at.column, reason);
  }

 private:
  /// The next line that is not blank.
  std::optional<std::string_view> next_line() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      const std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++line_number_;
      if (!without_blanks(line).empty()) return line;
    }
    return std::nullopt;
  }

  void read_header() {
    std::vector<std::string> names(columns.size());
    std::ranges::transform(columns, names.begin(), [](const Column& column) { return column.name; });
    const auto line = next_line();
    if (!line)
      throw InputError("{}:1:1: the file is empty; it must begin with a header of {}", name_, fmt::join(names, ", "));
    for (const Field& field : split(*line, line_number_)) {
      const auto at = std::ranges::find(names, field.text);
      if (at == names.end())
        fail(field, fmt::format("unknown column '{}' in the header.{} Allowed: {}", excerpt(field.text),
                                did_you_mean(field.text, names), fmt::join(names, ", ")));
      const auto index = static_cast<ColumnIndex>(at - names.begin());
      if (has(index)) fail(field, fmt::format("column '{}' stands twice in the header", field.text));
      order_.push_back(index);
    }
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns.at(i).required && !has(static_cast<ColumnIndex>(i)))
        fail({*line, line_number_, 1},
             fmt::format("the header has no column '{}', which is required", columns.at(i).name));
  }

  Row read_row(std::string_view line) const {
    const std::vector<Field> fields = split(line, line_number_);
    if (fields.size() != order_.size())
      fail({line, line_number_, fields.size() > order_.size() ? fields[order_.size()].column : line.size() + 1},
           fmt::format("{} fields, but the header has {}", fields.size(), order_.size()));
    Row row;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      row.value.at(order_[i]) = number(fields[i], columns.at(order_[i]));
      if (order_[i] == ColumnIndex::step) row.step_field = fields[i];
      if (order_[i] == ColumnIndex::height) row.height_field = fields[i];
    }
    return row;
  }

  [[nodiscard]] double number(const Field& field, const Column& column) const {
    const double value = number_in<double>(field.text).value_or(std::nan(""));
    if (!(value >= column.minimum && value <= column.maximum) || (column.whole && value != std::floor(value)))
      fail(field, fmt::format("{} is '{}'; use a {} from {} to {}", column.name, excerpt(field.text),
                              column.whole ? "whole number" : "number", column.minimum, column.maximum));
    return value;
  }

  std::string_view rest_;
  std::string_view name_;
  std::size_t line_number_ = 0;
  std::vector<ColumnIndex> order_;
};

/// The heights of the file in ascending order, each with the first row that has it; checked to be evenly spaced.
std::map<double, const Row*> evenly_spaced_heights(const std::vector<Row>& rows, const Reader& reader) {
  std::map<double, const Row*> heights;
  for (const Row& row : rows) {
    heights.emplace(row.value[ColumnIndex::height], &row);
    if (heights.size() > largest_heights)
      reader.fail(row.height_field, fmt::format("more than {} different heights", largest_heights));
  }
  if (heights.size() < 2)
    reader.fail(rows.front().height_field, "all rows have the same height; at least two heights are needed");
  const double first_m = heights.begin()->first;
  const double spacing_m = std::next(heights.begin())->first - first_m;
  if (spacing_m < limits::height_step_min_m * (1.0 - rounding))
    reader.fail(std::next(heights.begin())->second->height_field,
                fmt::format("the lowest two heights are {:g} m apart; use at least {:g} m", spacing_m,
                            limits::height_step_min_m));
  std::size_t i = 0;
  for (const auto& [height_m, row] : heights) {
    const double expected_m = first_m + spacing_m * static_cast<double>(i++);
    if (std::fabs(height_m - expected_m) > rounding * spacing_m)
      reader.fail(row->height_field, fmt::format("height_m {} breaks the even spacing of {} m from {} m; expected {}",
                                                 height_m, spacing_m, first_m, expected_m));
  }
  return heights;
}

/// The rows in the layout [(step - 1) * heights + level]; every cell must be there exactly once.
std::vector<const Row*> as_grid(const std::vector<Row>& rows, const std::map<double, const Row*>& heights,
                                const Reader& reader) {
  const std::size_t levels = heights.size();
  std::map<double, std::size_t> level_of;
  for (const auto& [height_m, row] : heights) level_of.emplace(height_m, level_of.size());
  double steps = 0;
  for (const Row& row : rows) steps = std::max(steps, row.value[ColumnIndex::step]);
  if (steps * static_cast<double>(levels) > static_cast<double>(limits::cells))
    reader.fail(rows.front().step_field,
                fmt::format("{} steps of {} heights are too many; at most {} values are possible", steps, levels,
                            limits::cells));
  // If there are fewer rows than cells, one of the first rows.size() + 1 cells is empty: more need not be kept.
  std::vector<const Row*> grid(std::min(static_cast<std::size_t>(steps) * levels, rows.size() + 1), nullptr);
  for (const Row& row : rows) {
    const auto step_index = static_cast<std::size_t>(row.value[ColumnIndex::step]) - 1;
    const std::size_t at = step_index * levels + level_of.at(row.value[ColumnIndex::height]);
    if (at >= grid.size()) continue;
    const Row*& cell = grid[at];
    if (cell)
      reader.fail(row.step_field, fmt::format("step {} at height {} m is already in line {}", step_index + 1,
                                              row.value[ColumnIndex::height], cell->step_field.line));
    cell = &row;
  }
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (!grid[i])
      reader.fail(
          rows.back().step_field,
          fmt::format("the file ends without step {} at height {} m; every step from 1 to {} needs all {} heights",
                      i / levels + 1, std::next(heights.begin(), static_cast<std::ptrdiff_t>(i % levels))->first, steps,
                      levels));
  return grid;
}

}  // namespace

double sinr_from_throughput_db(double throughput_kbps) noexcept {
  struct Pair {
    double throughput_kbps;
    double sinr_db;
  };
  constexpr std::array<Pair, 6> pairs{
      {{29'020, 3.4}, {35'080, 6.4}, {46'740, 9.9}, {46'760, 10.3}, {46'800, 11.1}, {76'650, 20.2}}};
  std::size_t i = 1;
  while (i + 1 < pairs.size() && throughput_kbps > pairs.at(i).throughput_kbps) ++i;
  const Pair& low = pairs.at(i - 1);
  const Pair& high = pairs.at(i);
  return low.sinr_db + (high.sinr_db - low.sinr_db) * (throughput_kbps - low.throughput_kbps) /
                           (high.throughput_kbps - low.throughput_kbps);
}

namespace {

/// The SINR of a row, for files without sinr_db.
double derived_sinr_db(const Row& row, const Reader& reader) {
  const double sinr_db = sinr_from_throughput_db(row.value[ColumnIndex::throughput]);
  if (std::fabs(sinr_db) > limits::level_db)
    reader.fail(row.step_field,
                fmt::format("throughput_kbps {} means an SINR of {:.0f} dB, beyond {} dB, because the file has no "
                            "column sinr_db; add it, or give throughput_kbps in kbit/s",
                            row.value[ColumnIndex::throughput], sinr_db, limits::level_db));
  return sinr_db;
}

}  // namespace

MeasuredFlight parse_measured_flight(std::string_view csv, std::string_view name) {
  Reader reader(csv, name);
  const std::vector<Row> rows = reader.read();
  const auto heights = evenly_spaced_heights(rows, reader);
  const std::vector<const Row*> grid = as_grid(rows, heights, reader);

  MeasuredFlight flight;
  flight.height_min_m = heights.begin()->first;
  flight.height_step_m = std::max(std::next(heights.begin())->first - flight.height_min_m, limits::height_step_min_m);
  flight.heights = static_cast<std::uint32_t>(heights.size());
  flight.steps = static_cast<std::uint32_t>(grid.size() / heights.size());
  flight.sinr_derived = !reader.has(ColumnIndex::sinr);
  for (const Row* row : grid) {
    flight.throughput_kbps.push_back(row->value[ColumnIndex::throughput]);
    flight.sinr_db.push_back(flight.sinr_derived ? derived_sinr_db(*row, reader) : row->value[ColumnIndex::sinr]);
    if (reader.has(ColumnIndex::serving_cell))
      flight.serving_cell.push_back(static_cast<std::int32_t>(row->value[ColumnIndex::serving_cell]));
  }
  return flight;
}

}  // namespace aloft::world
