#pragma once

#include <cstdint>

#include "common/world/world.hpp"

namespace aloft::radio {

/// The published simulator's ray is reversed: see blocking_height_m.
enum class LosRay : std::uint8_t { published, geometric };

/// The lowest height, m, at which a UAV above `uav` has line of sight to a base station at `station`. Equal to the base
/// stations' height if no building is in the way.
///
/// The rule is that of the published simulator. A building counts if its centre, in axes from the UAV towards the base
/// station at horizontal distance r, has 0 < lx < r and |ly| <= width / (2 sin 45 deg). It blocks if its height H
/// exceeds the ray at lx. The ray is h + (b-h) lx/r (geometric) or, in the published simulator, b + (h-b) lx/r, where b
/// is the base stations' height; so H blocks below b + (H-b) / q with q = 1 - lx/r or, published, lx/r. Valid for UAVs
/// at least as high as b.
[[nodiscard]] double blocking_height_m(const world::City& city, LosRay ray, world::Position uav,
                                       world::Position station) noexcept;

}  // namespace aloft::radio
