#pragma once

#include <memory>

#include "common/radio/signal_map.hpp"

namespace aloft::radio {

/// The map of a measured flight: throughput at every step and height, as recorded. All positions are (0, 0). The
/// observation before the first action is read in the first step's column.
[[nodiscard]] std::unique_ptr<SignalMap> make_measured_map(const world::MeasuredFlight& flight);

}  // namespace aloft::radio
