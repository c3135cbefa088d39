// All agents but those with a network: the paper's baselines, the filters and the planners.
#include "common/base/cores.hpp"
#include "services/agent_host/agent_host.hpp"
#include "services/runtime/service.hpp"

int main(int argc, char** argv) {
  using namespace aloft;
  const runtime::ServiceInfo info{.name = "aloft-baseline-agent",
                                  .description = "Flies UAVs with all agents but those of aloft-learning-agent.",
                                  .in_worker = true};
  agent_host::AgentHostOptions options{.host = agents::Host::baseline_agent, .threads = usable_cores()};
  return runtime::run_service(
      argc, argv, info,
      [&](CLI::App& app) {
        app.add_option("--strength", options.strength, "Of two processes with the same agent, the stronger flies")
            ->capture_default_str();
        app.add_option("--agents", options.agents, "Serve only these agents [all]")->delimiter(',');
      },
      [&](runtime::Service& service) { agent_host::host_agents(service.bus, options, service.stop); });
}
