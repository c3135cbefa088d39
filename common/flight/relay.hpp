#pragma once

#include "common/flight/flight.hpp"

namespace aloft::flight {

/// Flies a relay as its crew's entries say: every member that is aboard receives every report and commands every step,
/// and the pilot's command is executed.
[[nodiscard]] FlightRecord fly_relay(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial,
                                     const agents::AgentSpec& relay, const Costs& costs = {});

}  // namespace aloft::flight
