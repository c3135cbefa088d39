#pragma once

#include <span>

#include "common/world/world.hpp"

namespace aloft::world {

/// A place on the ellipsoid of WGS 84, degrees.
struct GeoPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;  ///< -180 to 180
};

/// The mean of places that lie near each other, also across the meridian of 180 degrees. There must be one at least.
[[nodiscard]] GeoPosition mean_position(std::span<const GeoPosition> places);

/// Metres east (x) and north (y) of a place: equirectangular, with the ellipsoid's radii of curvature there. Distances
/// from that place are right to 0.1 % up to 10 km away, at latitudes up to 60 degrees.
class LocalProjection {
 public:
  explicit LocalProjection(GeoPosition origin);

  [[nodiscard]] Position operator()(GeoPosition place) const;
  /// The place at this position.
  [[nodiscard]] GeoPosition inverse(Position position) const;

 private:
  GeoPosition origin_;
  double east_m_per_deg_;
  double north_m_per_deg_;
};

}  // namespace aloft::world
