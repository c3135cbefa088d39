#include "common/experiment/relay_rules.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

namespace aloft::experiment {
namespace {

/// On the bus a name identifies an agent, so all uses of a name must mean the same agent.
void check_names(const Experiment& experiment) {
  std::map<std::string, const agents::AgentSpec*> known;
  for (const agents::AgentSpec& spec : experiment.agents) known.emplace(spec.name, &spec);
  for (const agents::AgentSpec& relay : experiment.agents)
    for (const agents::CrewMember& member : relay.crew) {
      const auto [other, is_new] = known.emplace(member.agent.name, &member.agent);
      if (!is_new && other->second->to_json() != member.agent.to_json())
        throw InputError(
            "agents: \"{}\" in the crew of \"{}\" is not the agent that has this name elsewhere; give one "
            "of them another \"name\"",
            member.agent.name, relay.name);
    }
}

void check_steps(const Experiment& experiment, const agents::AgentSpec& relay) {
  for (const Condition& condition : experiment.conditions) {
    if (condition.kind != WorldKind::generated) continue;  // the file determines the length of a measured flight
    const auto steps = static_cast<std::uint32_t>(condition.world.integer("steps"));
    for (const agents::CrewMember& member : relay.crew)
      if (member.from_step > steps)
        throw InputError(
            "agents: \"{}\" in the crew of \"{}\" would fly from step {}, but the flights of condition "
            "\"{}\" have {} steps; use 2 to {}",
            member.agent.name, relay.name, member.from_step, condition.name, steps, steps);
  }
}

void check_standbys(const Experiment& experiment, const agents::AgentSpec& relay) {
  if (experiment.on_agent_loss == OnAgentLoss::failover) return;
  for (const agents::CrewMember& member : relay.crew)
    if (member.from_step == 0)
      throw InputError(
          "agents: \"{}\" in the crew of \"{}\" would never fly, because a flight whose agent is lost "
          "starts again; give it a \"from_step\", or set \"on_agent_loss\" to \"failover\"",
          member.agent.name, relay.name);
}

}  // namespace

void check_relays(const Experiment& experiment) {
  check_names(experiment);
  const auto is_relay = [](const agents::AgentSpec& spec) { return !spec.crew.empty(); };
  if (experiment.on_agent_loss == OnAgentLoss::failover && std::ranges::none_of(experiment.agents, is_relay))
    throw InputError(
        "on_agent_loss: \"failover\" needs an agent that can take over: put the agents that share a flight into the "
        "crew of an agent of type 'relay'");
  for (const agents::AgentSpec& relay : experiment.agents) {
    if (!is_relay(relay)) continue;
    check_steps(experiment, relay);
    check_standbys(experiment, relay);
  }
}

}  // namespace aloft::experiment
