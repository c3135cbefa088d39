#pragma once

#include <optional>
#include <vector>

#include "common/world/world.hpp"

namespace aloft::world {

/// What an operator knew of a measured flight beforehand. Positions are metres east (x) and north (y) of the middle of
/// the route.
struct MeasuredSites {
  std::vector<Site> sites;        ///< by cell, as in MeasuredFlight::serving_cell
  std::vector<Position> route;    ///< [step - 1]
  double antenna_height_m = 0.0;  ///< of every site
  std::optional<double> power_w;  ///< of every site, if it is known
  bool sectors = false;           ///< whether the sites have sector antennas
};

/// A measured flight, and what was known of it beforehand, if anything.
struct MeasuredWorld {
  MeasuredFlight flight;
  std::optional<MeasuredSites> known;
};

}  // namespace aloft::world
