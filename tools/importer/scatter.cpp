#include "tools/importer/scatter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "common/base/limits.hpp"
#include "common/world/csv_table.hpp"

namespace aloft::importer {
namespace {

enum ScatterColumn : std::size_t { latitude, longitude, altitude, value, cell, time, count };

using ScatterRow = world::CsvRow<ScatterColumn::count>;

constexpr double farthest_m = 50e3;  // from the middle: the ground counts as flat

struct ValueRange {
  double least;
  double most;
};

ValueRange range_of(Quantity quantity, double kbps_per_unit) {
  switch (quantity) {
    case Quantity::rsrp_dbm:
      return {-200, 50};
    case Quantity::rsrq_db:
      return {-60, 20};
    case Quantity::sinr_db:
      return {-200, 200};
    default:
      return {0, limits::quality / kbps_per_unit};
  }
}

/// No two columns of the file can be the same.
void check_names(const ScatterColumns& columns) {
  std::set<std::string> names;
  for (const std::string& name :
       {columns.latitude, columns.longitude, columns.altitude, columns.value, columns.cell, columns.time})
    if (!name.empty() && !names.insert(name).second)
      throw InputError("the column '{}' is named for two things; give each its own column", name);
}

}  // namespace

const char* unit_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::rsrp_dbm:
    case Quantity::rsrq_db:
    case Quantity::sinr_db:
      return "dB";
    default:
      return "kbit/s";
  }
}

Scatter parse_scatter(std::string_view csv, std::string_view name, const ScatterColumns& columns) {
  check_names(columns);
  const auto [least, most] = range_of(columns.quantity, columns.kbps_per_unit);
  const std::array<world::CsvColumn, ScatterColumn::count> facts{{
      {columns.latitude.c_str(), true, -90, 90, false},
      {columns.longitude.c_str(), true, -180, 180, false},
      {columns.altitude.c_str(), true, -1'000, 20'000, false},
      {columns.value.c_str(), true, least, most, false},
      {columns.cell.c_str(), !columns.cell.empty(), 0, 2147483647, true},
      {columns.time.c_str(), !columns.time.empty(), 0, 1e13, false, true},
  }};
  world::CsvReader reader(csv, name, facts, "one row per sample", world::OtherColumns::ignored);
  const std::vector<ScatterRow> rows = reader.read<ScatterColumn::count>();

  std::vector<world::GeoPosition> places;
  places.reserve(rows.size());
  for (const ScatterRow& row : rows)
    places.push_back({row.value[ScatterColumn::latitude], row.value[ScatterColumn::longitude]});
  Scatter scatter{columns.quantity, !columns.cell.empty(), !columns.time.empty(), world::mean_position(places), {}};
  const world::LocalProjection projection(scatter.middle);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ScatterRow& row = rows[i];
    const world::Position position = projection(places[i]);
    const double distance_m = std::hypot(position.x_m, position.y_m);
    if (distance_m > farthest_m)
      reader.fail(row, ScatterColumn::latitude,
                  fmt::format("{:.0f} km from the middle of the samples; at most {:.0f} km are possible",
                              distance_m / 1e3, farthest_m / 1e3));
    scatter.samples.push_back({.position = position,
                               .height_m = row.value[ScatterColumn::altitude] - columns.ground_m,
                               .value = row.value[ScatterColumn::value] *
                                        (columns.quantity == Quantity::throughput_kbps ? columns.kbps_per_unit : 1.0),
                               .cell = static_cast<std::int32_t>(row.value[ScatterColumn::cell]),
                               .time_s = row.value[ScatterColumn::time]});
  }
  return scatter;
}

}  // namespace aloft::importer
