#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/agents/registry.hpp"

namespace aloft::fuzz {

/// An agent of every type that runs inside the agent processes, and a learner that remembers earlier flights. Small, so
/// that many flights can be tried.
inline const std::vector<agents::AgentSpec>& agents_with_state() {
  static const std::vector<agents::AgentSpec> specs = [] {
    std::vector<agents::AgentSpec> made;
    const auto add = [&](const nlohmann::json& entry) {
      made.push_back(agents::parse_agents(entry, "agents[0]").front());
    };
    for (const agents::AgentType& type : agents::agent_types())
      if (!type.foreign && !type.relay && type.name != "dqn") add(type.name);
    for (const char* memory : {"per-flight", "lifelong"})
      add({{"type", "dqn"},
           {"memory", memory},
           {"hidden_width", 8},
           {"hidden_layers", 1},
           {"epochs", 1},
           {"minibatch", 2},
           {"replay_capacity", 3}});
    return made;
  }();
  return specs;
}

}  // namespace aloft::fuzz
