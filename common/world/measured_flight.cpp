#include "common/world/measured_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/base/limits.hpp"
#include "common/world/csv_table.hpp"

namespace aloft::world {
namespace {

constexpr std::size_t largest_heights = 1000;
constexpr double rounding = 1e-6;  // allowed error of spacings, relative
static_assert(largest_heights <= limits::heights);

enum ColumnIndex : std::size_t { step, height, throughput, sinr, latitude, longitude, serving_cell, observed, count };

constexpr std::array<CsvColumn, ColumnIndex::count> columns{{
    {"step", true, 1, limits::steps, true},
    {"height_m", true, 0, 10'000, false},
    {"throughput_kbps", true, 0, limits::quality, false},
    {"sinr_db", false, -200, 200, false},
    {"latitude", false, -90, 90, false},
    {"longitude", false, -180, 180, false},
    {"serving_cell", false, 0, 2147483647, true},
    {"observed", false, 0, 1, true},
}};

using Row = CsvRow<ColumnIndex::count>;

/// The heights of the file in ascending order, each with the first row that has it; checked to be evenly spaced.
std::map<double, const Row*> evenly_spaced_heights(const std::vector<Row>& rows, const CsvReader& reader) {
  std::map<double, const Row*> heights;
  for (const Row& row : rows) {
    heights.emplace(row.value[ColumnIndex::height], &row);
    if (heights.size() > largest_heights)
      reader.fail(row, ColumnIndex::height, fmt::format("more than {} different heights", largest_heights));
  }
  if (heights.size() < 2)
    reader.fail(rows.front(), ColumnIndex::height, "all rows have the same height; at least two heights are needed");
  const double first_m = heights.begin()->first;
  const double spacing_m = std::next(heights.begin())->first - first_m;
  if (spacing_m < limits::height_step_min_m * (1.0 - rounding))
    reader.fail(*std::next(heights.begin())->second, ColumnIndex::height,
                fmt::format("the lowest two heights are {:g} m apart; use at least {:g} m", spacing_m,
                            limits::height_step_min_m));
  std::size_t i = 0;
  for (const auto& [height_m, row] : heights) {
    const double expected_m = first_m + spacing_m * static_cast<double>(i++);
    if (std::fabs(height_m - expected_m) > rounding * spacing_m)
      reader.fail(*row, ColumnIndex::height,
                  fmt::format("height_m {} breaks the even spacing of {} m from {} m; expected {}", height_m, spacing_m,
                              first_m, expected_m));
  }
  return heights;
}

/// The rows in the layout [(step - 1) * heights + level]; every cell must be there exactly once.
std::vector<const Row*> as_grid(const std::vector<Row>& rows, const std::map<double, const Row*>& heights,
                                const CsvReader& reader) {
  const std::size_t levels = heights.size();
  std::map<double, std::size_t> level_of;
  for (const auto& [height_m, row] : heights) level_of.emplace(height_m, level_of.size());
  double steps = 0;
  for (const Row& row : rows) steps = std::max(steps, row.value[ColumnIndex::step]);
  if (steps * static_cast<double>(levels) > static_cast<double>(limits::cells))
    reader.fail(rows.front(), ColumnIndex::step,
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
      reader.fail(row, ColumnIndex::step,
                  fmt::format("step {} at height {} m is already in line {}", step_index + 1,
                              row.value[ColumnIndex::height], cell->line));
    cell = &row;
  }
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (!grid[i])
      reader.fail(
          rows.back(), ColumnIndex::step,
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
double derived_sinr_db(const Row& row, const CsvReader& reader) {
  const double sinr_db = sinr_from_throughput_db(row.value[ColumnIndex::throughput]);
  if (std::fabs(sinr_db) > limits::level_db)
    reader.fail(row, ColumnIndex::step,
                fmt::format("throughput_kbps {} means an SINR of {:.0f} dB, beyond {} dB, because the file has no "
                            "column sinr_db; add it, or give throughput_kbps in kbit/s",
                            row.value[ColumnIndex::throughput], sinr_db, limits::level_db));
  return sinr_db;
}

/// Where the UAV was at a step: the middle of the places of its rows.
GeoPosition middle_of(std::span<const Row* const> rows) {
  std::vector<GeoPosition> places;
  for (const Row* row : rows) places.push_back({row->value[ColumnIndex::latitude], row->value[ColumnIndex::longitude]});
  return mean_position(places);
}

}  // namespace

LocatedFlight parse_located_flight(std::string_view csv, std::string_view name) {
  CsvReader reader(csv, name, columns, "one row per (step, height)");
  const std::vector<Row> rows = reader.read<ColumnIndex::count>();
  const auto heights = evenly_spaced_heights(rows, reader);
  const std::vector<const Row*> grid = as_grid(rows, heights, reader);

  LocatedFlight located;
  MeasuredFlight& flight = located.flight;
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
  if (reader.has(ColumnIndex::latitude) && reader.has(ColumnIndex::longitude))
    for (std::size_t first = 0; first < grid.size(); first += flight.heights)
      located.route.push_back(middle_of(std::span(grid).subspan(first, flight.heights)));
  return located;
}

MeasuredFlight parse_measured_flight(std::string_view csv, std::string_view name) {
  return parse_located_flight(csv, name).flight;
}

}  // namespace aloft::world
