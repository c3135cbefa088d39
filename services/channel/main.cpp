// Flies the episodes of a worker's trials.
#include "common/base/limits.hpp"
#include "services/channel/channel.hpp"
#include "services/runtime/flag_checks.hpp"
#include "services/runtime/service.hpp"

int main(int argc, char** argv) {
  using namespace aloft;
  const runtime::ServiceInfo info{.name = "aloft-channel",
                                  .description = "Flies UAVs: executes height commands, measures the radio.",
                                  .in_worker = true};
  channel::ChannelOptions options;
  return runtime::run_service(
      argc, argv, info,
      [&](CLI::App& app) {
        app.add_option("--lanes", options.lanes, "Trials flown at the same time")
            ->check(runtime::whole_number(1, limits::lanes))
            ->capture_default_str();
        app.add_option("--agents", options.agents, "Take only flights of these agents [all]")->delimiter(',');
      },
      [&](runtime::Service& service) { channel::fly(service.bus, options, service.stop); });
}
