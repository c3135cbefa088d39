#pragma once

#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"

namespace aloft::environment {

/// Turns the trials that are leased to its worker into worlds: a generated city, or a measured flight. Returns
/// when the run is over or a stop is requested.
void make_worlds(const bus::BusOptions& place, StopSignal& stop);

}  // namespace aloft::environment
