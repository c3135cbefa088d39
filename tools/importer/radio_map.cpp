#include "tools/importer/radio_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"

namespace aloft::importer {
namespace {

constexpr double largest_dbm = 200.0;     // with either sign
constexpr double largest_axis_m = 100e3;  // with either sign
constexpr double mast_min_m = 1.0;        // of a file of base stations
constexpr double mast_max_m = 200.0;

void check_shape(const NpyArray& array, std::string_view axes, const std::vector<std::size_t>& shape) {
  if (array.shape() != shape)
    throw InputError("{}: has the shape ({}); it must be {}, which is ({}) here", array.name(),
                     fmt::join(array.shape(), ", "), axes, fmt::join(shape, ", "));
}

std::vector<double> read_axis(const NpzFile& file, std::string_view name) {
  const NpyArray array = file.array(name);
  if (array.shape().size() != 1 || array.size() < 2)
    throw InputError("{}: has the shape ({}); an axis is one list of at least two coordinates, m", array.name(),
                     fmt::join(array.shape(), ", "));
  std::vector<double> axis_m;
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (!(std::fabs(array[i]) <= largest_axis_m))
      throw InputError("{}[{}] is {}; use metres from {} to {}", array.name(), i, array[i], -largest_axis_m,
                       largest_axis_m);
    if (i > 0 && array[i] <= axis_m.back())
      throw InputError("{}[{}] is {}, not above {} before it; an axis must increase: sort it, and the map with it",
                       array.name(), i, array[i], axis_m.back());
    axis_m.push_back(array[i]);
  }
  return axis_m;
}

std::vector<std::int32_t> read_cells(const NpzFile& file, std::size_t count) {
  std::vector<std::int32_t> cells;
  for (std::size_t i = 0; i < count; ++i) cells.push_back(static_cast<std::int32_t>(i));
  if (!file.has("cell")) return cells;
  const NpyArray array = file.array("cell");
  check_shape(array, "[cell]", {count});
  constexpr double largest_cell = 2147483647;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(array[i] >= 0 && array[i] <= largest_cell) || array[i] != std::floor(array[i]))
      throw InputError("{}[{}] is {}; use whole numbers from 0 to {}", array.name(), i, array[i], largest_cell);
    cells[i] = static_cast<std::int32_t>(array[i]);
  }
  if (std::set<std::int32_t>(cells.begin(), cells.end()).size() != count)
    throw InputError("{}: a number stands there twice; give each cell its own", array.name());
  return cells;
}

std::vector<std::array<double, 3>> read_sites(const NpzFile& file, std::size_t count) {
  std::vector<std::array<double, 3>> sites_m;
  if (!file.has("site")) return sites_m;
  const NpyArray array = file.array("site");
  check_shape(array, "[cell, 3]", {count, 3});
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (!(std::fabs(array[i]) <= largest_axis_m))
      throw InputError("{}[{}, {}] is {}; use metres from {} to {}", array.name(), i / 3, i % 3, array[i],
                       -largest_axis_m, largest_axis_m);
    if (i % 3 == 0) sites_m.emplace_back();
    sites_m.back().at(i % 3) = array[i];
  }
  return sites_m;
}

/// Where a coordinate lies on an axis: between the points `low` and `low` + 1, `share` of the way.
struct OnAxis {
  std::size_t low = 0;
  double share = 0.0;
};

OnAxis find(const std::vector<double>& axis_m, double at_m) {
  const auto above = std::upper_bound(axis_m.begin() + 1, axis_m.end() - 1, at_m);
  const auto low = static_cast<std::size_t>(above - axis_m.begin()) - 1;
  return {low, (at_m - axis_m[low]) / (axis_m[low + 1] - axis_m[low])};
}

void check_within(const std::vector<double>& axis_m, double at_m, std::string_view axis, std::string_view what,
                  std::string_view where) {
  constexpr double rounding_m = 1e-6;
  if (at_m < axis_m.front() - rounding_m || at_m > axis_m.back() + rounding_m)
    throw InputError("{}: {} at {} = {:g} m leaves the map, which has {} from {:g} to {:g} m", where, what, axis, at_m,
                     axis, axis_m.front(), axis_m.back());
}

}  // namespace

RadioMap::RadioMap(const NpzFile& file, std::optional<double> floor_dbm)
    : x_m_(read_axis(file, "x")),
      y_m_(read_axis(file, "y")),
      z_m_(read_axis(file, "z")),
      power_dbm_(file.array("power_dbm")),
      floor_dbm_(floor_dbm.value_or(0.0)) {
  const std::size_t count = power_dbm_.shape().empty() ? 0 : power_dbm_.shape().front();
  check_shape(power_dbm_, "[cell, z, y, x]", {count, z_m_.size(), y_m_.size(), x_m_.size()});
  if (count > limits::base_stations)
    throw InputError("{}: has {} cells; at most {} are possible", power_dbm_.name(), count, limits::base_stations);
  cells_ = read_cells(file, count);
  sites_m_ = read_sites(file, count);
  for (std::size_t i = 0; i < power_dbm_.size(); ++i) {
    const double power = power_dbm_[i];
    if (std::fabs(power) <= largest_dbm || (floor_dbm && std::isinf(power) && power < 0.0)) continue;
    const std::size_t column = i / x_m_.size();
    const std::size_t layer = column / y_m_.size();
    throw InputError(
        "{}[{}, {}, {}, {}] is {}: a hole at z = {:g}, y = {:g}, x = {:g} m; all powers must be from {} to {} dBm. "
        "Fill holes before; --floor gives the power where a cell has none (-inf)",
        power_dbm_.name(), layer / z_m_.size(), layer % z_m_.size(), column % y_m_.size(), i % x_m_.size(), power,
        z_m_[layer % z_m_.size()], y_m_[column % y_m_.size()], x_m_[i % x_m_.size()], -largest_dbm, largest_dbm);
  }
}

double RadioMap::at(std::size_t cell, std::size_t z, std::size_t y, std::size_t x) const {
  const double power = power_dbm_[((cell * z_m_.size() + z) * y_m_.size() + y) * x_m_.size() + x];
  return std::isinf(power) ? floor_dbm_ : power;
}

std::vector<double> RadioMap::power_dbm(world::Position position, double height_m) const {
  const OnAxis z = find(z_m_, height_m);
  const OnAxis y = find(y_m_, position.y_m);
  const OnAxis x = find(x_m_, position.x_m);
  std::vector<double> powers(cells_.size(), 0.0);
  for (std::size_t cell = 0; cell < powers.size(); ++cell)
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t up = corner / 4;
      const std::size_t north = corner / 2 % 2;
      const std::size_t east = corner % 2;
      const double weight = (up == 1 ? z.share : 1.0 - z.share) * (north == 1 ? y.share : 1.0 - y.share) *
                            (east == 1 ? x.share : 1.0 - x.share);
      powers[cell] += weight * at(cell, z.low + up, y.low + north, x.low + east);
    }
  return powers;
}

ImportedWorld map_world(const RadioMap& map, const MapOptions& options, std::string_view where) {
  if (options.route.empty()) throw InputError("{}: a route is needed: --route X,Y X,Y ..., metres", where);
  for (const world::Position& corner : options.route) {
    check_within(map.x_m(), corner.x_m, "x", "--route", where);
    check_within(map.y_m(), corner.y_m, "y", "--route", where);
  }
  ImportedWorld world;
  world.has_sinr = true;
  world.has_cells = true;
  world.height_m = imported_heights(options.heights, map.z_m().front(), map.z_m().back(), where);
  for (const double height_m : world.height_m) check_within(map.z_m(), height_m, "z", "a height", where);
  const std::vector<world::Position> places = places_along(options.route, where);
  check_size(places.size(), world.height_m.size(), where);
  const world::LocalProjection projection(options.origin);
  constexpr double hz_per_mhz = 1e6;
  const double noise = noise_dbm(options.radio.bandwidth_mhz * hz_per_mhz, options.radio.noise_figure_db);
  for (const world::Position& place : places) {
    world.route.push_back(projection.inverse(place));
    for (const double height_m : world.height_m) {
      const Serving serving = strongest(map.power_dbm(place, height_m), noise);
      world.values.push_back({.throughput_kbps = throughput_kbps(serving.sinr_db, options.radio),
                              .sinr_db = serving.sinr_db,
                              .serving_cell = map.cells()[serving.cell]});
    }
  }
  return world;
}

std::string sites_csv(const RadioMap& map, world::GeoPosition origin, std::string_view where) {
  if (map.sites_m().empty()) return {};
  const world::LocalProjection projection(origin);
  std::string csv = "cell,latitude,longitude,antenna_height_m\n";
  for (std::size_t i = 0; i < map.sites_m().size(); ++i) {
    const auto& [x_m, y_m, z_m] = map.sites_m()[i];
    if (!(z_m >= mast_min_m && z_m <= mast_max_m))
      throw InputError("{}: site[{}, 2] is {}: antennas can be {} to {} m high; correct it, or leave 'site' out", where,
                       i, z_m, mast_min_m, mast_max_m);
    const world::GeoPosition place = projection.inverse({x_m, y_m});
    csv += fmt::format("{},{:.7f},{:.7f},{:g}\n", map.cells()[i], place.latitude_deg, place.longitude_deg, z_m);
  }
  return csv;
}

}  // namespace aloft::importer
