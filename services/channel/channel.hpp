#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"

namespace aloft::channel {

struct ChannelOptions {
  std::uint32_t lanes = 4;          ///< trials flown at the same time, 1 to 16
  std::vector<std::string> agents;  ///< whose flights this worker takes; empty: all
};

/// Flies the episodes of a worker's trials: asks agents, executes their commands, moves the UAVs, measures the radio,
/// and keeps every finished flight until it is stored. Returns when the run is over or a stop is requested.
void fly(const bus::BusOptions& place, const ChannelOptions& options, StopSignal& stop);

}  // namespace aloft::channel
