#include "tools/report/agent_list.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aloft::report {
namespace {

using agents::Look;

/// Looks for agents that register none, e.g. programs of the user's.
std::vector<Look> palette() {
  return {{"", 0, "#117733", "#66c285", {3, 2}}, {"", 0, "#aa3377", "#e07ab0", {6, 2}},
          {"", 0, "#4477aa", "#88b4dd", {3, 1}}, {"", 0, "#997700", "#d9b84a", {5, 3}},
          {"", 0, "#444444", "#d0d0d0", {7, 2}}, {"", 0, "#994455", "#e08a99", {2, 1}}};
}

}  // namespace

std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions) {
  std::vector<const AgentTrials*> agents;
  for (const ConditionTrials& condition : conditions)
    for (const AgentTrials& agent : condition.agents)
      if (std::ranges::none_of(agents, [&](const auto* other) { return other->name == agent.name; }))
        agents.push_back(&agent);
  std::ranges::stable_sort(agents, [](const auto* a, const auto* b) { return shown_before(*a, *b); });
  return agents;
}

nlohmann::json agent_list(std::span<const ConditionTrials> conditions) {
  const std::vector<const AgentTrials*> agents = agents_of(conditions);
  std::vector<Look> spare = palette();
  for (const AgentTrials* agent : agents)
    if (const Look* own = agents::agent_type(agent->type).look_of(agent->name); own != nullptr)
      std::erase_if(spare, [&](const Look& look) { return look.light == own->light; });
  if (spare.empty()) spare = palette();
  nlohmann::json list = nlohmann::json::array();
  std::size_t strangers = 0;
  for (const AgentTrials* agent : agents) {
    const agents::AgentType& type = agents::agent_type(agent->type);
    const Look* own = type.look_of(agent->name);
    const Look& look = own != nullptr ? *own : spare[strangers++ % spare.size()];
    list.push_back({{"name", agent->name},
                    {"type", agent->type},
                    {"learns", type.is_learner()},
                    {"privilege", agents::privilege_tier(agent->privilege).name},
                    {"colour", {{"light", look.light}, {"dark", look.dark}}},
                    {"dash", look.dash}});
  }
  return list;
}

}  // namespace aloft::report
