#include "services/channel/relay/swap_desk.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/nearest.hpp"

namespace aloft::channel {
namespace {

bool in_crew(const agents::AgentSpec& relay, std::string_view agent) {
  return std::ranges::any_of(relay.crew, [&](const agents::CrewMember& member) { return member.agent.name == agent; });
}

/// All agents of all crews.
std::vector<std::string> crews(const experiment::Experiment& experiment) {
  std::vector<std::string> names;
  for (const agents::AgentSpec& relay : experiment.agents)
    for (const agents::CrewMember& member : relay.crew)
      if (std::ranges::find(names, member.agent.name) == names.end()) names.push_back(member.agent.name);
  return names;
}

/// Steps of the longest flight that the agent can fly, in the air or later; 0 if unknown: the length of a measured
/// flight is known only while it is flown.
std::uint32_t longest_flight(std::string_view agent, const experiment::Experiment& experiment,
                             const SwapDesk::Episodes& episodes) {
  std::uint32_t longest = 0;
  std::set<std::uint32_t> known;
  for (const experiment::Condition& condition : experiment.conditions) {
    if (condition.kind != experiment::WorldKind::generated) continue;
    longest = std::max(longest, static_cast<std::uint32_t>(condition.world.integer("steps")));
    known.insert(condition.index);
  }
  for (const auto& episode : episodes) {
    if (!episode || !in_crew(episode->agent(), agent)) continue;
    longest = std::max(longest, episode->flight().info().steps);
    known.insert(episode->address().condition);
  }
  return known.size() == experiment.conditions.size() ? longest : 0;
}

/// Why the request cannot be met; empty if it can.
std::string objection(const wire::SwapRequest& request, const experiment::Experiment& experiment,
                      const AgentDirectory& agents, const SwapDesk::Episodes& episodes) {
  const std::string agent(wire::view(request.agent()));
  const std::vector<std::string> names = crews(experiment);
  if (names.empty())
    return fmt::format(
        "experiment '{}' has no agent of type 'relay', so its agents cannot be swapped; put those that "
        "share a flight into the crew of a relay",
        experiment.name);
  if (std::ranges::find(names, agent) == names.end())
    return fmt::format("agent '{}' is in no crew of experiment '{}'.{} In a crew: {}", agent, experiment.name,
                       did_you_mean(agent, names), fmt::join(names, ", "));
  if (experiment.on_agent_loss != experiment::OnAgentLoss::failover)
    return fmt::format(
        "experiment '{}' promises the same results in every run; write the swap into it (\"from_step\" "
        "in the crew), or set \"on_agent_loss\" to \"failover\"",
        experiment.name);
  if (agents.find(agent) == nullptr)
    return fmt::format("agent '{}' is not there; see the log of the process that hosts it", agent);
  const std::uint32_t steps = longest_flight(agent, experiment, episodes);
  if (steps > 0 && request.from_step() > steps)
    return fmt::format("step {} is not allowed, because no flight of experiment '{}' has more than {}; use 1 to {}",
                       request.from_step(), experiment.name, steps, steps);
  return {};
}

}  // namespace

std::vector<Episode*> SwapDesk::handle(const wire::SwapRequest& request, const experiment::Experiment& experiment,
                                       const AgentDirectory& agents, const Episodes& episodes, Clock::time_point now) {
  if (request.request_id() == reply_.request_id()) return {};
  const std::string error = objection(request, experiment, agents, episodes);
  reply_ = {};
  reply_.request_id(request.request_id());
  reply_.accepted(error.empty());
  reply_.message(wire::message(error));
  open_.clear();
  std::vector<Episode*> to_ask;
  if (!error.empty()) return to_ask;
  const SwapOrder order{std::string(wire::view(request.agent())), request.from_step()};
  for (const agents::AgentSpec& relay : experiment.agents)
    if (in_crew(relay, order.agent)) orders_.insert_or_assign(relay.name, order);
  for (const std::unique_ptr<Episode>& episode : episodes) {
    if (!episode || !in_crew(episode->agent(), order.agent)) continue;
    open_.insert(episode->address().attempt);
    if (episode->order(order, now)) to_ask.push_back(episode.get());
  }
  recount(episodes);
  return to_ask;
}

bool SwapDesk::recount(const Episodes& episodes) {
  const auto concerned = static_cast<std::uint32_t>(open_.size());
  std::uint32_t waiting = 0;
  for (const std::unique_ptr<Episode>& episode : episodes)
    if (episode && episode->order_open() && open_.contains(episode->address().attempt)) ++waiting;
  const bool changed = reply_.flights_waiting() != waiting;
  reply_.flights_waiting(waiting);
  reply_.flights_flown(concerned - waiting);
  return changed;
}

void SwapDesk::brief(Episode& episode, Clock::time_point now) const {
  const auto order = orders_.find(episode.agent().name);
  if (order == orders_.end()) return;
  episode.order(order->second, now);
  if (const std::uint32_t steps = episode.flight().info().steps; order->second.from_step > steps)
    spdlog::warn("agent {} was ordered to fly from step {} on, but this flight (condition {}, trial {}) has {} steps",
                 order->second.agent, order->second.from_step, episode.address().condition, episode.address().trial,
                 steps);
}

}  // namespace aloft::channel
