#pragma once

#include <span>
#include <string_view>

#include "common/world/local_projection.hpp"
#include "common/world/measured_world.hpp"

namespace aloft::world {

/// How far from the middle of the route base stations, and the route itself, may lie: the map is flat.
inline constexpr double measured_map_radius_m = 50e3;

/// The base stations of a measured flight from CSV text: columns cell, latitude, longitude, antenna_height_m, and
/// optionally power_w and azimuth_deg (clockwise from north), in any order; one row per base station, in any order.
/// Heights and powers become the medians of theirs, because the link budget has one of each. `route`: where the flight
/// was, at least one place. `name` is the file's name in messages. Throws InputError as parse_measured_flight.
[[nodiscard]] MeasuredSites parse_measured_sites(std::string_view csv, std::string_view name,
                                                 std::span<const GeoPosition> route);

}  // namespace aloft::world
