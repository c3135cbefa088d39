#include "common/flight/relay.hpp"

#include <memory>
#include <vector>

#include "common/agents/relay.hpp"

namespace aloft::flight {

FlightRecord fly_relay(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, const agents::AgentSpec& relay,
                       const Costs& costs) {
  Flight flight(map, seed, trial, costs);
  std::vector<std::unique_ptr<agents::Agent>> aboard(relay.crew.size());
  std::vector<agents::Command> commands(relay.crew.size());
  while (true) {
    const agents::Observation& report = flight.observation();
    for (std::size_t i = 0; i < relay.crew.size(); ++i) {
      const agents::CrewMember& member = relay.crew[i];
      const agents::Privilege privilege = member.agent.privilege();
      if (member.from_step == 0)
        continue;  // a standby takes over only from an agent that fails, and none fails in this process
      const bool boards = member.boards_at() == report.step;
      if (boards) {
        aboard[i] = member.agent.make();
        aboard[i]->begin(flight.info());
      }
      if (!aboard[i]) continue;
      if (const auto known = survey(flight, privilege, boards)) aboard[i]->survey(*known);
      aboard[i]->observe(report);
      if (!flight.finished()) commands[i] = aboard[i]->act();
    }
    if (flight.finished()) return std::move(flight).record();
    const std::size_t pilot = agents::written_pilot(relay.crew, report.step + 1);
    execute(flight, commands[pilot], relay.crew[pilot].agent);
  }
}

}  // namespace aloft::flight
