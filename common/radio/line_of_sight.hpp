#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/world/world.hpp"

namespace aloft::radio {

/// The published simulator's ray is reversed: see Skyline::blocking_height_m.
enum class LosRay : std::uint8_t { published, geometric };

/// Buildings in the order in which a ray meets them that goes mainly along one axis: the city is cut into parts along
/// this axis, and the buildings of a part are sorted by the lines of the building grid across it.
struct BuildingOrder {
  double low_end_m = 0.0;  ///< of the city
  double parts_per_m = 1.0;
  std::size_t parts = 1;
  double lines_per_m = 0.0;
  std::size_t lines = 0;
  std::vector<std::uint32_t> first;  ///< [part][line] the first building; at the end, their number
  // Per building its centre, and how much higher than the base stations it is; some more follow that block nothing.
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> rise_m;

  /// The part that has this position; positions outside of the city count to the part at that end.
  [[nodiscard]] std::size_t part(double along_m) const noexcept {
    const double index = (along_m - low_end_m) * parts_per_m;
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(parts - 1)));
  }
  /// The end of the buildings of a part on lines at or below this position: line i is at (i + 0.5) / lines_per_m.
  [[nodiscard]] std::uint32_t up_to(std::size_t part, double across_m) const noexcept {
    const double line = (across_m - low_end_m) * lines_per_m + 0.5;
    return first[part * lines + static_cast<std::size_t>(std::clamp(line, 0.0, static_cast<double>(lines)))];
  }
};

/// The buildings of a city that are higher than its base stations: no other one can be in the way.
class Skyline {
 public:
  explicit Skyline(const world::City& city);

  /// The lowest height, m, at which a UAV above `uav` has line of sight to a base station at `station`. Equal to the
  /// base stations' height if no building is in the way.
  ///
  /// The rule is that of the published simulator. A building counts if its centre, in axes from the UAV towards the
  /// base station at horizontal distance r, has 0 < lx < r and |ly| <= width / (2 sin 45 deg). It blocks if its height
  /// H exceeds the ray at lx. The ray is h + (b-h) lx/r (geometric) or, in the published simulator, b + (h-b) lx/r,
  /// where b is the base stations' height; so H blocks below b + (H-b) / q with q = 1 - lx/r or, published, lx/r.
  /// Valid for UAVs at least as high as b.
  [[nodiscard]] double blocking_height_m(LosRay ray, const world::Position& uav,
                                         const world::Position& station) const noexcept;

 private:
  double base_m_;
  double width_m_;  // of a building
  BuildingOrder along_x_;
  BuildingOrder along_y_;
};

}  // namespace aloft::radio
