#pragma once

#include <string_view>
#include <vector>

#include "common/world/local_projection.hpp"
#include "common/world/world.hpp"

namespace aloft::world {

/// SINR for a throughput: piecewise linear interpolation, and linear extrapolation, of the pairs that the published
/// code has, (29.02 Mbit/s, 3.4 dB) ... (76.65 Mbit/s, 20.2 dB).
[[nodiscard]] double sinr_from_throughput_db(double throughput_kbps) noexcept;

/// A measured flight from CSV text: columns step, height_m, throughput_kbps, and optionally sinr_db, latitude,
/// longitude, serving_cell, observed, in any order; one row per (step, height), in any order; steps from 1 without
/// gaps; the same evenly spaced heights at every step. `name` is the file's name in messages. Throws InputError
/// "name:line:column: reason", where column counts characters from 1.
[[nodiscard]] MeasuredFlight parse_measured_flight(std::string_view csv, std::string_view name);

/// A measured flight, and where it was.
struct LocatedFlight {
  MeasuredFlight flight;
  std::vector<GeoPosition> route;  ///< [step - 1]; the mean over the rows of a step; empty if not in the file
};

/// The same with the columns latitude and longitude.
[[nodiscard]] LocatedFlight parse_located_flight(std::string_view csv, std::string_view name);

}  // namespace aloft::world
