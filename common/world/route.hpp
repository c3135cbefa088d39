#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::world {

/// The parameters of a route, which runs along x with y near 0.
[[nodiscard]] const std::vector<ParameterSpec>& route_parameters();

/// The ground track over a city: points 0..steps at x = route_start_x_m + point * route_spacing_m, and y within
/// route_offset_max_m (the paper's d) of the straight line y = 0.
class Route {
 public:
  /// `world` holds at least the keys of route_parameters().
  Route(const Parameters& world, const City& city);

  /// Actions in a flight; there are steps() + 1 points.
  [[nodiscard]] std::uint32_t steps() const noexcept { return static_cast<std::uint32_t>(nearest_y_m_.size()) - 1; }
  /// Rule `nearest`: the route depends on the point alone.
  [[nodiscard]] bool fixed() const noexcept { return fixed_; }
  [[nodiscard]] Position start() const noexcept;
  /// Rule `nearest`: y is that of the base station nearest to (x, 0), clamped to +-d.
  /// Rule `serving`: from `from`, y goes towards the serving base station by at most d and stays within +-d; without a
  /// serving base station (negative index) y stays.
  [[nodiscard]] Position advance(std::uint32_t point, Position from, std::int32_t serving_cell) const noexcept;

 private:
  [[nodiscard]] double x_m(std::uint32_t point) const noexcept { return start_x_m_ + spacing_m_ * point; }

  double start_x_m_;
  double spacing_m_;
  double offset_max_m_;
  bool fixed_;
  std::vector<double> nearest_y_m_;  // per point; rule `nearest`
  std::vector<double> station_y_m_;  // per base station; rule `serving`
};

}  // namespace aloft::world
