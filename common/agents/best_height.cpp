#include "common/agents/best_height.hpp"

#include <algorithm>
#include <cmath>

namespace aloft::agents {

double best_height_m(const HeightProfile& profile, double resolution_m) {
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::floor(resolution_m / profile.resolution_m + 0.5)));
  std::size_t best = 0;
  for (std::size_t i = stride; i < profile.qos.size(); i += stride)
    if (profile.qos[i] > profile.qos[best]) best = i;
  return profile.height_min_m + profile.resolution_m * static_cast<double>(best);
}

}  // namespace aloft::agents
