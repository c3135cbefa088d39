#include "common/world/route.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace aloft::world {
namespace {

/// The route rules; true: the whole route is known before the flight.
constexpr std::array<Choice<bool>, 2> route_rules{{{"nearest", true}, {"serving", false}}};

/// y of the base station that is horizontally nearest to (x_m, 0); the first of equally near ones.
double y_of_nearest_station_m(const City& city, double x_m) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  double y_m = 0.0;
  for (const Position& station : city.base_stations) {
    const double dx_m = station.x_m - x_m;
    const double distance_m2 = dx_m * dx_m + station.y_m * station.y_m;
    if (distance_m2 < nearest_m2) {
      nearest_m2 = distance_m2;
      y_m = station.y_m;
    }
  }
  return y_m;
}

}  // namespace

const std::vector<ParameterSpec>& route_parameters() {
  static const std::vector<ParameterSpec> table = {
      choice_parameter("route", route_rules,
                       "Rule for y: that of the nearest base station, or stepwise towards the serving one."),
      integer_parameter("steps", 100, 1, 10'000, "Actions in a flight; the route has one point more."),
      number_parameter("route_start_x_m", -505.0, -5000.0, 5000.0, "x of the first route point."),
      number_parameter("route_spacing_m", 10.0, 0.1, 1000.0, "Distance between route points along x."),
      number_parameter("route_offset_max_m", 10.0, 0.0, 1000.0,
                       "Largest distance from the line y = 0, and per step of rule serving; default: height_step_m."),
  };
  return table;
}

Route::Route(const Parameters& world, const City& city)
    : start_x_m_(world.number("route_start_x_m")),
      spacing_m_(world.number("route_spacing_m")),
      offset_max_m_(world.number("route_offset_max_m")),
      fixed_(world.chosen("route", route_rules)),
      nearest_y_m_(static_cast<std::size_t>(world.integer("steps")) + 1) {
  if (fixed_)
    for (std::uint32_t point = 0; point <= steps(); ++point)
      nearest_y_m_[point] = std::clamp(y_of_nearest_station_m(city, x_m(point)), -offset_max_m_, offset_max_m_);
  for (const Position& station : city.base_stations) station_y_m_.push_back(station.y_m);
}

Position Route::start() const noexcept {
  return {x_m(0), nearest_y_m_[0]};  // rule `serving`: on the line
}

Position Route::advance(std::uint32_t point, Position from, std::int32_t serving_cell) const noexcept {
  if (fixed_) return {x_m(point), nearest_y_m_[point]};
  const bool served = serving_cell >= 0 && static_cast<std::size_t>(serving_cell) < station_y_m_.size();
  const double towards_m = served ? station_y_m_[static_cast<std::size_t>(serving_cell)] - from.y_m : 0.0;
  const double y_m = from.y_m + std::clamp(towards_m, -offset_max_m_, offset_max_m_);
  return {x_m(point), std::clamp(y_m, -offset_max_m_, offset_max_m_)};
}

}  // namespace aloft::world
