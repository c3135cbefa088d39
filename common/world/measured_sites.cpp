#include "common/world/measured_sites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "common/base/limits.hpp"
#include "common/world/csv_table.hpp"

namespace aloft::world {
namespace {

namespace site_column {
enum Index : std::size_t { cell, latitude, longitude, antenna_height, power, azimuth, count };
}
using SiteColumn = site_column::Index;

/// Heights and powers have the ranges of base_station_height_m and tx_power_w of generated worlds.
constexpr std::array<CsvColumn, SiteColumn::count> site_columns{{
    {"cell", true, 0, 2147483647, true},
    {"latitude", true, -90, 90, false},
    {"longitude", true, -180, 180, false},
    {"antenna_height_m", true, 1, 200, false},
    {"power_w", false, 0.001, 1000, false},
    {"azimuth_deg", false, 0, 360, false},
}};

using SiteRow = CsvRow<SiteColumn::count>;

/// From clockwise from north to counterclockwise from east, -180 to 180.
double from_east_deg(double clockwise_from_north_deg) {
  return std::remainder(90.0 - clockwise_from_north_deg, 360.0);
}

double median(const std::vector<SiteRow>& rows, SiteColumn column) {
  std::vector<double> values(rows.size());
  std::ranges::transform(rows, values.begin(), [column](const SiteRow& row) { return row.value.at(column); });
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The rows by cell; each cell must be there once.
std::map<std::int32_t, const SiteRow*> by_cell(const std::vector<SiteRow>& rows, const CsvReader& reader) {
  std::map<std::int32_t, const SiteRow*> found;
  for (const SiteRow& row : rows) {
    const auto number = static_cast<std::int32_t>(row.value[SiteColumn::cell]);
    const auto [other, is_new] = found.emplace(number, &row);
    if (!is_new)
      reader.fail(row, SiteColumn::cell, fmt::format("cell {} is already in line {}", number, other->second->line));
    if (found.size() > limits::base_stations)
      reader.fail(row, SiteColumn::cell, fmt::format("more than {} base stations", limits::base_stations));
  }
  return found;
}

Position position_of(const SiteRow& row, const LocalProjection& projection, const CsvReader& reader) {
  const Position position = projection({row.value[SiteColumn::latitude], row.value[SiteColumn::longitude]});
  const double distance_m = std::sqrt(position.x_m * position.x_m + position.y_m * position.y_m);
  if (distance_m > measured_map_radius_m)
    reader.fail(row, SiteColumn::latitude,
                fmt::format("this base station is {:.0f} km from the middle of the route; at most {:.0f} km are "
                            "possible: leave it out, or correct its latitude and longitude",
                            distance_m / 1e3, measured_map_radius_m / 1e3));
  return position;
}

}  // namespace

MeasuredSites parse_measured_sites(std::string_view csv, std::string_view name, std::span<const GeoPosition> route) {
  CsvReader reader(csv, name, site_columns, "one row per base station");
  const std::vector<SiteRow> rows = reader.read<SiteColumn::count>();
  const LocalProjection projection(mean_position(route));
  MeasuredSites known;
  known.sectors = reader.has(SiteColumn::azimuth);
  for (const auto& [number, row] : by_cell(rows, reader))
    known.sites.push_back({number, position_of(*row, projection, reader),
                           known.sectors ? from_east_deg(row->value[SiteColumn::azimuth]) : 0.0});
  for (const GeoPosition& place : route) known.route.push_back(projection(place));
  known.antenna_height_m = median(rows, SiteColumn::antenna_height);
  if (reader.has(SiteColumn::power)) known.power_w = median(rows, SiteColumn::power);
  return known;
}

}  // namespace aloft::world
