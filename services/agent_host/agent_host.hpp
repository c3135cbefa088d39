#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"

namespace aloft::agent_host {

struct AgentHostOptions {
  agents::Host host{};                ///< agents of this host's types are served
  unsigned threads = 1;               ///< for agents that can compute for long; the others run in the loop itself
  std::uint32_t strength = 10;        ///< DDS ownership strength: the strongest live process flies
  std::vector<std::string> agents{};  ///< serve only these; empty: all
};

/// Serves every agent of the running experiment whose type belongs to its host, on every stream of its worker, until
/// the run ends or a stop is requested.
void host_agents(const bus::BusOptions& place, const AgentHostOptions& options, StopSignal& stop);

}  // namespace aloft::agent_host
