#include "common/agents/smoothed_levels.hpp"

#include <algorithm>
#include <cmath>

#include "common/agents/steering.hpp"

namespace aloft::agents {

std::vector<double> smoothed_levels(const HeightProfile& profile, const FlightInfo& flight, double smoothing_m) {
  const auto stride = static_cast<std::size_t>(std::floor(flight.height_step_m / profile.resolution_m + 0.5));
  const auto reach = static_cast<std::size_t>(std::floor(smoothing_m / profile.resolution_m + 1e-6));
  std::vector<double> levels(level_count(flight));
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const std::size_t centre = level * stride;
    const std::size_t first = centre - std::min(centre, reach);
    const std::size_t last = std::min(centre + reach, profile.qos.size() - 1);
    double sum = 0.0;
    for (std::size_t i = first; i <= last; ++i) sum += profile.qos.at(i);
    levels[level] = sum / static_cast<double>(last - first + 1);
  }
  return levels;
}

}  // namespace aloft::agents
