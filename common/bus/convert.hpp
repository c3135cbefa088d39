#pragma once

#include "common/agents/agent.hpp"
#include "common/agents/registry.hpp"
#include "common/base/process_name.hpp"
#include "common/bus/wire.hpp"
#include "common/world/measured_world.hpp"
#include "common/world/world.hpp"

/// Conversions between the types on the wire and the types of the domain.
namespace aloft::bus {

void put(wire::ChannelReport& report, const agents::FlightInfo& flight);
void put(wire::ChannelReport& report, const agents::Observation& observation);
void put(wire::HeightCommand& message, const agents::Command& command);
void put(wire::HeightProfile& message, const agents::HeightProfile& profile);
void put(wire::SiteMap& message, const agents::SiteMap& map);
void put(wire::World& message, const world::City& city);
void put(wire::World& message, const world::MeasuredWorld& measured);

[[nodiscard]] agents::FlightInfo flight_info(const wire::ChannelReport& report);
[[nodiscard]] agents::Observation observation(const wire::ChannelReport& report);
/// Not for ACTION_UNKNOWN_FLIGHT (std::logic_error).
[[nodiscard]] agents::Command command(const wire::HeightCommand& message);
[[nodiscard]] agents::HeightProfile profile(const wire::HeightProfile& message);
/// InputError if its radio is no world's. Updates have no radio.
[[nodiscard]] agents::SiteMap site_map(const wire::SiteMap& message);
[[nodiscard]] world::City city(const wire::World& message);
[[nodiscard]] world::MeasuredWorld measured_world(const wire::World& message);

[[nodiscard]] wire::ProcessName to_wire(const ProcessName& process);
[[nodiscard]] ProcessName from_wire(const wire::ProcessName& process);
[[nodiscard]] wire::Privilege to_wire(agents::Privilege privilege);
[[nodiscard]] agents::Privilege from_wire(wire::Privilege privilege);

}  // namespace aloft::bus
