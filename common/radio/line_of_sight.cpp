#include "common/radio/line_of_sight.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/base/widest_vectors.hpp"

namespace aloft::radio {
namespace {

constexpr std::size_t lanes = 8;                 // buildings that are looked at together
constexpr std::size_t chunk = 64;                // buildings between two looks at what was found
constexpr std::size_t most_on_line = 2 * lanes;  // buildings, on average, of one part
constexpr double rounding_m = 1e-4;              // generous

/// From the UAV towards the base station.
struct Ray {
  world::Position uav;
  double ux = 0.0;
  double uy = 0.0;
  double length_m = 0.0;
  double half_width_m = 0.0;
};

/// Raises `greatest_m` to the greatest (H-b) / q of buildings that are in the way; `size` is a multiple of `lanes`.
template <LosRay kind>
[[gnu::always_inline]] inline void blocking_loop(const Ray* ray, const double* x_m, const double* y_m,
                                                 const double* rise_m, std::size_t size, double* greatest_m) {
  std::array<double, chunk> lx_m;
  std::array<double, chunk> blocking_m;  // H-b of buildings in the way, else 0
  for (std::size_t first = 0; first < size; first += chunk) {
    const std::size_t count = std::min(chunk, size - first) / lanes * lanes;
    std::uint64_t any_bits = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double to_x_m = x_m[first + i] - ray->uav.x_m;
      const double to_y_m = y_m[first + i] - ray->uav.y_m;
      lx_m[i] = to_x_m * ray->ux + to_y_m * ray->uy;
      const double ly_m = to_y_m * ray->ux - to_x_m * ray->uy;
      const double ahead_m = lx_m[i] > 0.0 ? rise_m[first + i] : 0.0;
      const double between_m = lx_m[i] < ray->length_m ? ahead_m : 0.0;
      blocking_m[i] = std::fabs(ly_m) <= ray->half_width_m ? between_m : 0.0;
      any_bits |= std::bit_cast<std::uint64_t>(blocking_m[i]);
    }
    if (any_bits == 0) continue;
    for (std::size_t i = 0; i < count; ++i) {
      if (blocking_m[i] == 0.0) continue;
      const double from_low_end = kind == LosRay::published ? lx_m[i] / ray->length_m : 1.0 - lx_m[i] / ray->length_m;
      *greatest_m = std::max(*greatest_m, blocking_m[i] / from_low_end);
    }
  }
}

template <LosRay kind>
void find_greatest(const Ray& ray, const BuildingOrder& order, std::size_t first, std::size_t size,
                   double& greatest_m) noexcept {
  run_vectorised<blocking_loop<kind>>(&ray, order.x_m.data() + first, order.y_m.data() + first,
                                      order.rise_m.data() + first, (size + lanes - 1) / lanes * lanes, &greatest_m);
}

struct Interval {
  double low_m = 0.0;
  double high_m = 0.0;
};

/// From `a_m` to `b_m` in any order, and so much more on both sides.
Interval interval(double a_m, double b_m, double margin_m) noexcept {
  return {std::min(a_m, b_m) - margin_m, std::max(a_m, b_m) + margin_m};
}

struct Building {
  std::size_t ix;
  std::size_t iy;
  world::Position centre;
  double rise_m;
};

std::vector<Building> high_buildings(const world::City& city) {
  std::vector<Building> high;
  for (std::uint32_t iy = 0; iy < city.buildings_y; ++iy) {
    for (std::uint32_t ix = 0; ix < city.buildings_x; ++ix) {
      const double height_m = city.building_height_m[std::size_t{iy} * city.buildings_x + ix];
      if (height_m > city.base_station_height_m)
        high.push_back({ix, iy, city.building_centre(ix, iy), height_m - city.base_station_height_m});
    }
  }
  return high;
}

BuildingOrder order(const std::vector<Building>& buildings, bool along_x, const world::City& city) {
  BuildingOrder sorted;
  sorted.low_end_m = -0.5 * city.window_m;
  sorted.lines = along_x ? city.buildings_y : city.buildings_x;
  sorted.lines_per_m = static_cast<double>(sorted.lines) / city.window_m;
  if (sorted.lines > 0) sorted.parts = 1 + buildings.size() / sorted.lines / most_on_line;
  sorted.parts_per_m = static_cast<double>(sorted.parts) / city.window_m;
  const auto place = [&](const Building& building) {
    const std::size_t part = sorted.part(along_x ? building.centre.x_m : building.centre.y_m);
    return part * sorted.lines + (along_x ? building.iy : building.ix);
  };
  sorted.first.resize(sorted.parts * sorted.lines + 1);
  for (const Building& building : buildings) ++sorted.first[place(building) + 1];
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  std::vector<std::uint32_t> next = sorted.first;
  for (std::vector<double>* values : {&sorted.x_m, &sorted.y_m, &sorted.rise_m})
    values->resize(buildings.size() + lanes);
  for (const Building& building : buildings) {
    const std::uint32_t at = next[place(building)]++;
    sorted.x_m[at] = building.centre.x_m;
    sorted.y_m[at] = building.centre.y_m;
    sorted.rise_m[at] = building.rise_m;
  }
  return sorted;
}

}  // namespace

Skyline::Skyline(const world::City& city) : base_m_(city.base_station_height_m), width_m_(city.building_width_m) {
  const std::vector<Building> high = high_buildings(city);
  along_x_ = order(high, true, city);
  along_y_ = order(high, false, city);
}

double Skyline::blocking_height_m(LosRay kind, const world::Position& uav,
                                  const world::Position& station) const noexcept {
  const double dx_m = station.x_m - uav.x_m;
  const double dy_m = station.y_m - uav.y_m;
  const double r_m = std::sqrt(dx_m * dx_m + dy_m * dy_m);
  if (r_m == 0.0) return base_m_;
  const Ray ray{uav, dx_m / r_m, dy_m / r_m, r_m, width_m_ / std::numbers::sqrt2};  // w / (2 sin 45 deg)

  // All buildings on the lines that the strip around the ray touches. Positions are relative to the city's low ends.
  const bool along_x = std::fabs(dx_m) >= std::fabs(dy_m);
  const BuildingOrder& order = along_x ? along_x_ : along_y_;
  const double margin_m = ray.half_width_m + rounding_m;
  const Interval along = interval(along_x ? uav.x_m : uav.y_m, along_x ? station.x_m : station.y_m, margin_m);
  const Interval across = interval(along_x ? uav.y_m : uav.x_m, along_x ? station.y_m : station.x_m, margin_m);
  double greatest_m = 0.0;
  const std::size_t last_part = order.part(along.high_m);
  for (std::size_t part = order.part(along.low_m); part <= last_part; ++part) {
    Interval strip = across;
    if (order.parts > 1) {  // of the ray within this part; where it ends does not matter
      const double part_low_m = order.low_end_m + static_cast<double>(part) / order.parts_per_m;
      const double part_high_m = part_low_m + 1.0 / order.parts_per_m;
      const double slope = along_x ? dy_m / dx_m : dx_m / dy_m;
      const auto on_ray_m = [&](double position_m) {
        return (along_x ? uav.y_m : uav.x_m) + slope * (position_m - (along_x ? uav.x_m : uav.y_m));
      };
      strip = interval(on_ray_m(std::max(along.low_m, part_low_m)), on_ray_m(std::min(along.high_m, part_high_m)),
                       width_m_ + rounding_m);  // the strip is at most sqrt(2) times wider across than around the ray
    }
    const std::uint32_t first = order.up_to(part, strip.low_m);
    const std::uint32_t last = order.up_to(part, strip.high_m);
    if (first >= last) continue;
    if (kind == LosRay::published)
      find_greatest<LosRay::published>(ray, order, first, last - first, greatest_m);
    else
      find_greatest<LosRay::geometric>(ray, order, first, last - first, greatest_m);
  }
  return base_m_ + greatest_m;
}

}  // namespace aloft::radio
