#pragma once

#include "common/agents/observation.hpp"

namespace aloft::agents {

/// The height with the best quality among the lowest and those at multiples of `resolution_m` above it (of the
/// profile's own resolution, if that is coarser); the lowest of equally good ones.
[[nodiscard]] double best_height_m(const HeightProfile& profile, double resolution_m);

}  // namespace aloft::agents
