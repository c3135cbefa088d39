#pragma once

#include "common/agents/observation.hpp"

namespace aloft::agents {

/// The height with the best quality among those `resolution_m` apart from the lowest (the profile's own resolution if
/// that is coarser); the lowest of equals.
[[nodiscard]] double best_height_m(const HeightProfile& profile, double resolution_m);

}  // namespace aloft::agents
