#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/importer/imported_world.hpp"
#include "tools/importer/link_quality.hpp"
#include "tools/importer/npz.hpp"

namespace aloft::importer {

/// The power that each cell would give at the points of a grid, as ray tracers compute it.
class RadioMap {
 public:
  /// Arrays of the file: power_dbm [cell, z, y, x], the axes x, y and z in metres, and optionally cell [cell], their
  /// numbers (0, 1, ... without it), and site [cell, 3], the antennas' places x, y, z in metres. `floor_dbm` stands for
  /// minus infinity, no power at all, which is refused without it. InputError if an array is missing, has another
  /// shape, a value is not finite or out of range, or an axis does not increase.
  RadioMap(const NpzFile& file, std::optional<double> floor_dbm);

  [[nodiscard]] const std::vector<double>& x_m() const noexcept { return x_m_; }
  [[nodiscard]] const std::vector<double>& y_m() const noexcept { return y_m_; }
  [[nodiscard]] const std::vector<double>& z_m() const noexcept { return z_m_; }
  [[nodiscard]] const std::vector<std::int32_t>& cells() const noexcept { return cells_; }
  /// [cell][x, y, z]; empty if the file has none.
  [[nodiscard]] const std::vector<std::array<double, 3>>& sites_m() const noexcept { return sites_m_; }

  /// Power of every cell at a place within the axes, dBm: linear between the points along each axis, in dB.
  [[nodiscard]] std::vector<double> power_dbm(world::Position position, double height_m) const;

 private:
  [[nodiscard]] double at(std::size_t cell, std::size_t z, std::size_t y, std::size_t x) const;

  std::vector<double> x_m_;
  std::vector<double> y_m_;
  std::vector<double> z_m_;
  std::vector<std::int32_t> cells_;
  std::vector<std::array<double, 3>> sites_m_;
  NpyArray power_dbm_;
  double floor_dbm_ = 0.0;
};

struct MapOptions {
  HeightOptions heights;
  std::vector<world::Position> route;  ///< corners, m
  world::GeoPosition origin;           ///< where x = y = 0
  RadioOptions radio;
};

/// The measured world along a route through the map: the strongest cell serves, its SINR is its power over noise (in
/// the bandwidth) and the sum of the others. InputError if the route or a height leaves the map.
[[nodiscard]] ImportedWorld map_world(const RadioMap& map, const MapOptions& options, std::string_view where);

/// The base stations, as a file beside a measured world; empty if the map has none. InputError if one's height is not
/// one that such a file can have.
[[nodiscard]] std::string sites_csv(const RadioMap& map, world::GeoPosition origin, std::string_view where);

}  // namespace aloft::importer
