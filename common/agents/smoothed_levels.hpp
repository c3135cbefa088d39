#pragma once

#include <vector>

#include "common/agents/observation.hpp"

namespace aloft::agents {

/// The quality at every level of the flight: the mean over the profile's heights within `smoothing_m` of the level.
/// Where fading is independent per height (every metre in generated worlds), most of it is gone in the mean.
[[nodiscard]] std::vector<double> smoothed_levels(const HeightProfile& profile, const FlightInfo& flight,
                                                  double smoothing_m);

}  // namespace aloft::agents
