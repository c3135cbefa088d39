#include <fmt/format.h>

#include "common/base/error.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/swap_order.hpp"

namespace aloft::cli {

void add_swap(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "swap", "Let another agent fly the relays of a worker, in mid-flight; needs \"on_agent_loss\": \"failover\"");
  auto options = std::make_shared<SwapOrder>();
  command->add_option("--run", options->place.run, "Name of the run (aloft run ... --run NAME)")
      ->required()
      ->check(runtime::bus_name());
  command->add_option("--worker", options->place.worker, "Worker, e.g. w0")->required()->check(runtime::bus_name());
  command->add_option("--agent", options->agent, "Who flies from then on: one of the relay's crew")
      ->required()
      ->check(agent_name());
  auto* at_step = command->add_option("--at-step", options->at_step, "The first step of every flight that it flies")
                      ->check(runtime::whole_number(1, 10000));
  command->add_flag("--now")->description("From the next step on [the default]")->excludes(at_step);
  runtime::add_bus_flags(*command, options->place);
  command->add_option("--limit", options->limit_s, "Seconds to wait until it flies")
      ->check(runtime::whole_number(1, 600))
      ->capture_default_str();
  command->callback([options, &job] {
    job = [options]() -> int {
      StopSignal stop;
      const std::string outcome = order_swap(*options, stop);
      if (outcome.empty()) return exit_interrupted;
      fmt::print("{}\n", outcome);
      return exit_ok;
    };
  });
}

}  // namespace aloft::cli
