#include "common/radio/line_of_sight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aloft::radio {
namespace {

/// One axis of the building grid.
struct Axis {
  double origin_m;   // centre of cell 0
  double spacing_m;  // between centres
  std::uint32_t cells;

  [[nodiscard]] double centre_m(std::uint32_t i) const noexcept { return origin_m + spacing_m * i; }
  /// Cells with a centre in [low, high], generously rounded: [first, last).
  [[nodiscard]] std::uint32_t first(double low_m) const noexcept {
    return clamped(std::floor((low_m - origin_m) / spacing_m - 1e-6) + 1.0);
  }
  [[nodiscard]] std::uint32_t last(double high_m) const noexcept {
    return clamped(std::floor((high_m - origin_m) / spacing_m + 1e-6) + 1.0);
  }

 private:
  [[nodiscard]] std::uint32_t clamped(double i) const noexcept {
    return static_cast<std::uint32_t>(std::clamp(i, 0.0, static_cast<double>(cells)));
  }
};

Axis axis(double window_m, std::uint32_t cells) noexcept {
  const double spacing_m = window_m / std::max(1U, cells);
  return {-0.5 * window_m + 0.5 * spacing_m, spacing_m, cells};
}

}  // namespace

double blocking_height_m(const world::City& city, LosRay ray, world::Position uav, world::Position station) noexcept {
  const double base_m = city.base_station_height_m;
  const double half_width_m = city.building_width_m / std::numbers::sqrt2;  // w / (2 sin 45 deg)
  const double dx_m = station.x_m - uav.x_m;
  const double dy_m = station.y_m - uav.y_m;
  const double r_m = std::sqrt(dx_m * dx_m + dy_m * dy_m);
  if (r_m == 0.0) return base_m;
  const double ux = dx_m / r_m;
  const double uy = dy_m / r_m;

  // Iterate along the grid axis closer to the ray's direction, and at each line only over the strip around the ray.
  const bool along_x = std::fabs(ux) >= std::fabs(uy);
  const Axis x_axis = axis(city.window_m, city.buildings_x);
  const Axis y_axis = axis(city.window_m, city.buildings_y);
  const Axis& along = along_x ? x_axis : y_axis;
  const Axis& across = along_x ? y_axis : x_axis;
  const double along_uav_m = along_x ? uav.x_m : uav.y_m;
  const double across_uav_m = along_x ? uav.y_m : uav.x_m;
  const double along_step_m = along_x ? dx_m : dy_m;
  const double slope = along_x ? dy_m / dx_m : dx_m / dy_m;
  const double strip_m = half_width_m / std::fabs(along_x ? ux : uy);

  double threshold_m = base_m;
  const std::uint32_t last_line = along.last(along_uav_m + std::max(0.0, along_step_m) + half_width_m);
  for (std::uint32_t line = along.first(along_uav_m + std::min(0.0, along_step_m) - half_width_m); line < last_line;
       ++line) {
    const double on_ray_m = across_uav_m + slope * (along.centre_m(line) - along_uav_m);
    const std::uint32_t last_cell = across.last(on_ray_m + strip_m);
    for (std::uint32_t cell = across.first(on_ray_m - strip_m); cell < last_cell; ++cell) {
      const std::uint32_t ix = along_x ? line : cell;
      const std::uint32_t iy = along_x ? cell : line;
      const double height_m = city.building_height_m[std::size_t{iy} * city.buildings_x + ix];
      if (height_m <= base_m) continue;
      const world::Position centre = city.building_centre(ix, iy);
      const double to_x_m = centre.x_m - uav.x_m;
      const double to_y_m = centre.y_m - uav.y_m;
      const double lx_m = to_x_m * ux + to_y_m * uy;
      const double ly_m = to_y_m * ux - to_x_m * uy;
      if (lx_m <= 0.0 || lx_m >= r_m || std::fabs(ly_m) > half_width_m) continue;
      const double from_low_end = ray == LosRay::published ? lx_m / r_m : 1.0 - lx_m / r_m;
      threshold_m = std::max(threshold_m, base_m + (height_m - base_m) / from_low_end);
    }
  }
  return threshold_m;
}

}  // namespace aloft::radio
