#pragma once

#include <cstdint>
#include <vector>

namespace aloft::world {

/// Horizontal position, m; the city's centre is (0, 0).
struct Position {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// A generated city: base stations and a grid of buildings.
struct City {
  double window_m = 0.0;               ///< the city covers [-window/2, window/2] in x and y
  double base_station_height_m = 0.0;  ///< of every antenna
  std::vector<Position> base_stations;
  std::uint32_t buildings_x =
      0;  ///< grid columns; the centre of column i is at -window/2 + window (i + 0.5) / buildings_x
  std::uint32_t buildings_y = 0;  ///< grid rows, likewise
  double building_width_m = 0.0;
  std::vector<double> building_height_m;  ///< row-major: [iy * buildings_x + ix]

  [[nodiscard]] Position building_centre(std::uint32_t ix, std::uint32_t iy) const noexcept {
    return {-0.5 * window_m + window_m * (ix + 0.5) / buildings_x,
            -0.5 * window_m + window_m * (iy + 0.5) / buildings_y};
  }
};

/// A base station as the operator's site map has it.
struct Site {
  std::int32_t cell = -1;  ///< its number in reports: Reading::serving_cell
  Position position;
  double azimuth_deg = 0.0;  ///< of its sector antenna, counterclockwise from +x; 0 if it has none
};

/// What an operator knows of a city: where the base stations are, with errors, and how large the errors are.
struct SiteMap {
  std::vector<Site> sites;         ///< by cell
  double position_error_m = 0.0;   ///< standard deviation of the positions per axis
  double missing = 0.0;            ///< share of the base stations that are not on the map
  std::uint32_t route_points = 0;  ///< points of the route ahead that are told at a time; 0: all
};

/// A measured flight: the throughput and SINR that a UAV would have had at every height of every step.
struct MeasuredFlight {
  double height_min_m = 0.0;
  double height_step_m = 0.0;
  std::uint32_t heights = 0;
  std::uint32_t steps = 0;
  bool sinr_derived = false;               ///< the file had no sinr_db; it was interpolated from the throughput
  std::vector<double> throughput_kbps;     ///< [(step - 1) * heights + level]
  std::vector<double> sinr_db;             ///< same layout, always filled
  std::vector<std::int32_t> serving_cell;  ///< same layout; empty if not in the file
};

}  // namespace aloft::world
