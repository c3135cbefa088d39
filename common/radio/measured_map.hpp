#pragma once

#include <memory>
#include <optional>

#include "common/radio/signal_map.hpp"
#include "common/world/measured_world.hpp"

namespace aloft::radio {

/// What an operator knew of a measured flight: its base stations, and the radio of preset `published` with their
/// height, power and antennas, at the heights of the flight. That radio holds at or above the masts, so higher ones
/// count as high as the lowest height. InputError if the heights are beyond those of generated worlds.
[[nodiscard]] Survey measured_survey(const world::MeasuredFlight& flight, const world::MeasuredSites& known);

/// The map of a measured flight: throughput at every step and height, as recorded. Without `known` all positions are
/// (0, 0), and there is no survey. The observation before the first action is read in the first step's column.
/// InputError as from measured_survey().
[[nodiscard]] std::unique_ptr<SignalMap> make_measured_map(const world::MeasuredFlight& flight,
                                                           const std::optional<world::MeasuredSites>& known = {});

}  // namespace aloft::radio
