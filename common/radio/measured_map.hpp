#pragma once

#include <memory>

#include "common/radio/signal_map.hpp"

namespace aloft::radio {

/// A measured flight: throughput at every step and height, as recorded. It has no positions: all are (0, 0). The
/// observation before the first action is read at the first step's place.
[[nodiscard]] std::unique_ptr<SignalMap> make_measured_map(const world::MeasuredFlight& flight);

}  // namespace aloft::radio
