#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "common/agents/relay.hpp"
#include "common/base/error.hpp"
#include "common/flight/flight.hpp"

namespace aloft::flight {

using agents::Privilege;

void foresee(const Flight& flight, Privilege privilege, agents::HeightProfile& buffer,
             const std::function<void(const agents::HeightProfile&)>& deliver) {
  if (privilege == Privilege::none || flight.finished()) return;
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

namespace {

void execute(Flight& flight, const agents::Command& command, const agents::AgentSpec& pilot) {
  if (command.action == agents::Action::absolute && !agents::agent_type(pilot.type).unconstrained)
    throw std::logic_error(fmt::format("agent '{}' may not jump to a height", pilot.name));
  flight.step(command, pilot.name);
}

}  // namespace

FlightRecord fly(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, agents::Agent& agent,
                 const agents::AgentSpec& spec, const Costs& costs) {
  const agents::AgentType& type = agents::agent_type(spec.type);
  Flight flight(map, seed, trial, costs);
  agents::HeightProfile buffer;
  const auto deliver = [&agent](const agents::HeightProfile& profile) { agent.foresee(profile); };
  agent.begin(flight.info());
  while (true) {
    foresee(flight, type.privilege, buffer, deliver);
    agent.observe(flight.observation());
    if (flight.finished()) return std::move(flight).record();
    execute(flight, agent.act(), spec);
  }
}

FlightRecord fly_relay(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, const agents::AgentSpec& relay,
                       const Costs& costs) {
  Flight flight(map, seed, trial, costs);
  std::vector<std::unique_ptr<agents::Agent>> aboard(relay.crew.size());
  std::vector<agents::Command> commands(relay.crew.size());
  while (true) {
    const agents::Observation& report = flight.observation();
    for (std::size_t i = 0; i < relay.crew.size(); ++i) {
      const agents::CrewMember& member = relay.crew[i];
      if (member.from_step == 0) continue;  // nobody dies here, so nobody takes over
      if (member.boards_at() == report.step) {
        aboard[i] = member.agent.make();
        aboard[i]->begin(flight.info());
      }
      if (!aboard[i]) continue;
      aboard[i]->observe(report);
      if (!flight.finished()) commands[i] = aboard[i]->act();
    }
    if (flight.finished()) return std::move(flight).record();
    const std::size_t pilot = agents::written_pilot(relay.crew, report.step + 1);
    execute(flight, commands[pilot], relay.crew[pilot].agent);
  }
}

}  // namespace aloft::flight
