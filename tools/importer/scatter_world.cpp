#include "tools/importer/scatter_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/error.hpp"

namespace aloft::importer {
namespace {

constexpr double reference_symbol_hz = 15e3;  // of one resource element, over which RSRP is measured

/// The way of the samples around the lowest height, in order of time or of the file: those at least a step apart.
std::vector<world::Position> lowest_way(const Scatter& scatter, double height_m, double within_m) {
  std::vector<const Sample*> low;
  for (const Sample& sample : scatter.samples)
    if (std::fabs(sample.height_m - height_m) <= within_m) low.push_back(&sample);
  std::ranges::stable_sort(low, {}, &Sample::time_s);
  std::vector<world::Position> corners;
  for (const Sample* sample : low)
    if (corners.empty() || std::hypot(sample->position.x_m - corners.back().x_m,
                                      sample->position.y_m - corners.back().y_m) >= step_spacing_m)
      corners.push_back(sample->position);
  return corners;
}

/// The corners of the route in metres from the middle of the samples.
std::vector<world::Position> corners_of(const Scatter& scatter, const ScatterOptions& options, double height_m,
                                        std::string_view where) {
  std::vector<world::Position> corners;
  const world::LocalProjection projection(scatter.middle);
  for (const world::Position& point : options.route) {
    if (!(std::fabs(point.x_m) <= 90.0 && std::fabs(point.y_m) <= 180.0))
      throw InputError("--route {:g},{:g}: use a latitude from -90 to 90 and a longitude from -180 to 180 degrees",
                       point.x_m, point.y_m);
    corners.push_back(projection({point.x_m, point.y_m}));
  }
  const double within_m = 0.5 * options.heights.step_m;
  if (options.route.empty()) corners = lowest_way(scatter, height_m, within_m);
  if (corners.empty())
    throw InputError(
        "{}: no samples within {:g} m of {:g} m, the lowest height, so that there is no way to follow: "
        "correct --height-min or --ground, or give --route",
        where, within_m, height_m);
  return corners;
}

/// The level of the serving cell: its SINR, RSRQ or throughput.
ImportedValue value_of(const CellValues& known, Quantity quantity, const RadioOptions& radio) {
  ImportedValue value{.serving_cell = known.nearest_cell};
  if (quantity == Quantity::rsrp_dbm) {
    std::vector<double> power_dbm;
    std::ranges::transform(known.by_cell, std::back_inserter(power_dbm), &CellValue::value);
    const Serving serving = strongest(power_dbm, noise_dbm(reference_symbol_hz, radio.noise_figure_db));
    value.serving_cell = known.by_cell[serving.cell].cell;
    value.sinr_db = serving.sinr_db;
  } else if (quantity == Quantity::throughput_kbps) {
    value.throughput_kbps = known.of(value.serving_cell).value();
    return value;
  } else {
    value.sinr_db = known.of(value.serving_cell).value();
    if (quantity == Quantity::rsrq_db) value.sinr_db = sinr_from_rsrq_db(value.sinr_db, radio.serving_load);
  }
  value.throughput_kbps = throughput_kbps(value.sinr_db, radio);
  return value;
}

/// Fills one height: each value that was not observed becomes that of the nearest step where there is one.
void fill(ImportedWorld& world, std::size_t level, double hole_max_m, const Reach& reach, std::string_view where) {
  const std::size_t levels = world.height_m.size();
  const std::size_t steps = world.route.size();
  const auto observed = [&](std::size_t step) { return world.values[step * levels + level].observed; };
  for (std::size_t step = 0; step < steps; ++step) {
    if (observed(step)) continue;
    std::size_t distance = 1;
    while (distance < steps && !(step >= distance && observed(step - distance)) &&
           !(step + distance < steps && observed(step + distance)))
      ++distance;
    const double distance_m = step_spacing_m * static_cast<double>(distance);
    if (distance == steps || distance_m > hole_max_m)
      throw InputError(
          "{}: a hole at step {} ({:.6f},{:.6f}) and {:g} m: no sample within {:g} m over the ground and {:g} m of "
          "height, and none along the route within {:g} m. Choose heights and a route that were measured, or enlarge "
          "--radius, --height-radius or --hole-max",
          where, step + 1, world.route[step].latitude_deg, world.route[step].longitude_deg, world.height_m[level],
          reach.radius_m, reach.height_radius_m, hole_max_m);
    const bool before = step >= distance && observed(step - distance);
    ImportedValue& value = world.values[step * levels + level];
    value = world.values[(before ? step - distance : step + distance) * levels + level];
    value.observed = false;
  }
}

struct ErrorSum {
  std::size_t samples = 0;
  std::size_t predicted = 0;
  double sum = 0.0;
  double squares = 0.0;

  void add(double measured, std::optional<double> prediction) {
    ++samples;
    if (!prediction) return;
    ++predicted;
    sum += *prediction - measured;
    squares += (*prediction - measured) * (*prediction - measured);
  }
  [[nodiscard]] HeldOutError error(std::int32_t cell) const {
    const double count = std::max(static_cast<double>(predicted), 1.0);
    return {cell, samples, predicted, sum / count, std::sqrt(squares / count)};
  }
};

}  // namespace

ImportedWorld scatter_world(const Scatter& scatter, const ScatterOptions& options, std::string_view where) {
  const auto [lowest, highest] = std::ranges::minmax(scatter.samples, {}, &Sample::height_m);
  ImportedWorld world;
  world.has_sinr = scatter.quantity != Quantity::throughput_kbps;
  world.has_cells = scatter.has_cells;
  world.has_observed = true;
  world.height_m = imported_heights(options.heights, lowest.height_m, highest.height_m, where);
  const std::vector<world::Position> places =
      places_along(corners_of(scatter, options, world.height_m.front(), where), where);
  check_size(places.size(), world.height_m.size(), where);
  const world::LocalProjection projection(scatter.middle);
  const ScatterField field(scatter.samples, options.reach);
  for (const world::Position& place : places) {
    world.route.push_back(projection.inverse(place));
    for (const double height_m : world.height_m) {
      const CellValues known = field.at(place, height_m);
      world.values.push_back(known.by_cell.empty() ? ImportedValue{.observed = false}
                                                   : value_of(known, scatter.quantity, options.radio));
    }
  }
  for (std::size_t level = 0; level < world.height_m.size(); ++level)
    fill(world, level, options.hole_max_m, options.reach, where);
  return world;
}

HeldOut held_out_error(const Scatter& scatter, const ScatterOptions& options) {
  const ScatterField field(scatter.samples, options.reach);
  ErrorSum all;
  std::map<std::int32_t, ErrorSum> by_cell;
  for (const Sample& sample : scatter.samples) {
    const auto near_in_time = [&](const Sample& other) {
      return &other == &sample || (scatter.has_times && std::fabs(other.time_s - sample.time_s) < options.apart_s);
    };
    const CellValues known = field.at(sample.position, sample.height_m, near_in_time);
    const std::optional<double> prediction =
        known.of(scatter.quantity == Quantity::rsrp_dbm ? sample.cell : known.nearest_cell);
    all.add(sample.value, prediction);
    by_cell[sample.cell].add(sample.value, prediction);
  }
  HeldOut held_out{all.error(0), {}};
  for (const auto& [cell, sum] : by_cell) held_out.by_cell.push_back(sum.error(cell));
  return held_out;
}

}  // namespace aloft::importer
