#include "common/world/local_projection.hpp"

#include <cmath>
#include <numbers>

namespace aloft::world {
namespace {

// WGS 84.
constexpr double semi_major_axis_m = 6'378'137.0;
constexpr double eccentricity_squared = 6.69437999014e-3;

constexpr double rad_per_deg = std::numbers::pi / 180.0;

/// -180 to 180.
double wrapped_deg(double longitude_deg) {
  return std::remainder(longitude_deg, 360.0);
}

}  // namespace

GeoPosition mean_position(std::span<const GeoPosition> places) {
  const GeoPosition first = places.front();
  double latitudes_deg = 0.0;
  double longitudes_deg = 0.0;
  for (const GeoPosition& place : places) {
    latitudes_deg += place.latitude_deg - first.latitude_deg;
    longitudes_deg += wrapped_deg(place.longitude_deg - first.longitude_deg);
  }
  const auto count = static_cast<double>(places.size());
  return {first.latitude_deg + latitudes_deg / count, wrapped_deg(first.longitude_deg + longitudes_deg / count)};
}

LocalProjection::LocalProjection(GeoPosition origin) : origin_(origin) {
  const double sine = std::sin(rad_per_deg * origin.latitude_deg);
  const double flattening = 1.0 - eccentricity_squared * sine * sine;
  const double east_radius_m = semi_major_axis_m / std::sqrt(flattening);                   // across the meridian
  const double north_radius_m = east_radius_m * (1.0 - eccentricity_squared) / flattening;  // along it
  east_m_per_deg_ = rad_per_deg * east_radius_m * std::cos(rad_per_deg * origin.latitude_deg);
  north_m_per_deg_ = rad_per_deg * north_radius_m;
}

Position LocalProjection::operator()(GeoPosition place) const {
  return {east_m_per_deg_ * wrapped_deg(place.longitude_deg - origin_.longitude_deg),
          north_m_per_deg_ * (place.latitude_deg - origin_.latitude_deg)};
}

GeoPosition LocalProjection::inverse(Position position) const {
  return {origin_.latitude_deg + position.y_m / north_m_per_deg_,
          wrapped_deg(origin_.longitude_deg + position.x_m / east_m_per_deg_)};
}

}  // namespace aloft::world
