#include "tools/importer/imported_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::importer {
namespace {

constexpr double multiple_rounding = 1e-6;  // of a multiple
constexpr double heights_at_most = 1000;

}  // namespace

std::vector<double> imported_heights(const HeightOptions& options, double lowest_m, double highest_m,
                                     std::string_view where) {
  const double step_m = options.step_m;
  const double min_m = options.min_m.value_or(step_m * std::ceil(std::max(lowest_m, 0.0) / step_m - multiple_rounding));
  const double max_m = options.max_m.value_or(step_m * std::floor(highest_m / step_m + multiple_rounding));
  const double levels = std::floor((max_m - min_m) / step_m + multiple_rounding) + 1;
  if (!(levels >= 2 && levels <= heights_at_most))
    throw InputError(
        "{}: {:g} heights from {:g} to {:g} m in steps of {:g} m; a measured world has 2 to {:g}. The data are from "
        "{:g} to {:g} m high: give --height-min, --height-max and --height-step",
        where, std::max(levels, 0.0), min_m, max_m, step_m, heights_at_most, lowest_m, highest_m);
  std::vector<double> height_m(static_cast<std::size_t>(levels), min_m);
  for (std::size_t level = 0; level < height_m.size(); ++level) height_m[level] += step_m * static_cast<double>(level);
  return height_m;
}

std::vector<world::Position> places_along(const std::vector<world::Position>& corners, std::string_view where) {
  std::vector<world::Position> places;
  double next_m = 0.0;  // of the next place, from the present corner
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const world::Position& from = corners[i];
    const world::Position& to = corners[i + 1];
    const double length_m = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    if (length_m / step_spacing_m + static_cast<double>(places.size()) > limits::steps)
      throw InputError("{}: the route is longer than {:g} km, which are {} steps of {:g} m; make it shorter", where,
                       limits::steps * step_spacing_m / 1e3, limits::steps, step_spacing_m);
    for (; next_m <= length_m * (1.0 + multiple_rounding); next_m += step_spacing_m) {
      const double share = length_m > 0.0 ? std::min(next_m / length_m, 1.0) : 0.0;
      places.push_back({from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)});
    }
    next_m -= length_m;
  }
  if (places.empty()) places.push_back(corners.front());
  return places;
}

void check_size(std::size_t steps, std::size_t heights, std::string_view where) {
  if (steps * heights > limits::cells)
    throw InputError("{}: {} steps of {} heights are too many; at most {} values are possible", where, steps, heights,
                     limits::cells);
}

std::string to_csv(const ImportedWorld& world) {
  std::string csv = "step,height_m,throughput_kbps,latitude,longitude";
  if (world.has_sinr) csv += ",sinr_db";
  if (world.has_cells) csv += ",serving_cell";
  if (world.has_observed) csv += ",observed";
  csv += '\n';
  const std::size_t levels = world.height_m.size();
  for (std::size_t i = 0; i < world.values.size(); ++i) {
    const ImportedValue& value = world.values[i];
    const world::GeoPosition& place = world.route[i / levels];
    csv += fmt::format("{},{:.10g},{:.1f},{:.7f},{:.7f}", i / levels + 1, world.height_m[i % levels],
                       value.throughput_kbps, place.latitude_deg, place.longitude_deg);
    if (world.has_sinr) csv += fmt::format(",{:.2f}", value.sinr_db);
    if (world.has_cells) csv += fmt::format(",{}", value.serving_cell);
    if (world.has_observed) csv += fmt::format(",{:d}", value.observed);
    csv += '\n';
  }
  return csv;
}

world::Position parse_point(std::string_view option, const std::string& text) {
  const std::size_t comma = text.find(',');
  const std::string_view all = text;
  const auto first = number_in<double>(all.substr(0, comma));
  const auto second = comma == std::string::npos ? std::optional<double>() : number_in<double>(all.substr(comma + 1));
  if (!first || !second || !std::isfinite(*first) || !std::isfinite(*second))
    throw InputError("{} {}: this is no point; use two numbers with a comma between them, such as 53.34,-6.24", option,
                     excerpt(text));
  return {*first, *second};
}

}  // namespace aloft::importer
