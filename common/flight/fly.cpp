#include <fmt/format.h>

#include <stdexcept>

#include "common/base/error.hpp"
#include "common/flight/flight.hpp"

namespace aloft::flight {

using agents::Privilege;

std::optional<agents::SiteMap> survey(const Flight& flight, Privilege privilege, bool first) {
  if (privilege != Privilege::site_map || flight.finished()) return std::nullopt;
  if (first) return flight.site_map(false);
  return flight.route_told_in_parts() ? std::optional(flight.site_map(true)) : std::nullopt;
}

void foresee(const Flight& flight, Privilege privilege, agents::HeightProfile& buffer,
             const std::function<void(const agents::HeightProfile&)>& deliver) {
  if (!agents::foresees(privilege) || flight.finished()) return;
  const std::uint32_t next = flight.observation().step + 1;
  if (privilege == Privilege::whole_route && next > 1) return;  // already delivered
  if (privilege == Privilege::whole_route && !flight.fixed_route())
    throw InputError(
        "an agent that plans the whole route needs one that is known beforehand, but the route rule 'serving' makes it "
        "depend on the flight; use the route rule 'nearest', or leave this agent out");
  const std::uint32_t last = privilege == Privilege::whole_route ? flight.info().steps : next;
  for (std::uint32_t step = next; step <= last; ++step) {
    flight.profile(step, buffer);
    deliver(buffer);
  }
}

void execute(Flight& flight, const agents::Command& command, const agents::AgentSpec& pilot) {
  if (command.action == agents::Action::absolute && !agents::agent_type(pilot.type).unconstrained)
    throw std::logic_error(fmt::format("agent '{}' may not jump to a height", pilot.name));
  flight.step(command, pilot.name);
}

FlightRecord fly(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, agents::Agent& agent,
                 const agents::AgentSpec& spec, const Costs& costs) {
  const agents::AgentType& type = agents::agent_type(spec.type);
  Flight flight(map, seed, trial, costs);
  agents::HeightProfile buffer;
  const auto deliver = [&agent](const agents::HeightProfile& profile) { agent.foresee(profile); };
  agent.begin(flight.info());
  while (true) {
    if (const auto known = survey(flight, type.privilege, flight.observation().step == 0)) agent.survey(*known);
    foresee(flight, type.privilege, buffer, deliver);
    agent.observe(flight.observation());
    if (flight.finished()) return std::move(flight).record();
    execute(flight, agent.act(), spec);
  }
}

}  // namespace aloft::flight
