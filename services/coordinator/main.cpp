#include <CLI/CLI.hpp>
#include <chrono>
#include <map>

#include "services/coordinator/coordinator_service.hpp"
#include "services/runtime/flag_checks.hpp"

namespace {

using aloft::coordinator::ServiceOptions;
using aloft::coordinator::TrialOrder;

void declare(CLI::App& app, ServiceOptions& options) {
  auto& coordinator = options.coordinator;
  const auto seconds_into = [](aloft::coordinator::Clock::duration& target) {
    return [&target](const double& seconds) {
      target = std::chrono::duration_cast<aloft::coordinator::Clock::duration>(std::chrono::duration<double>(seconds));
    };
  };
  app.add_option("--experiment", options.experiment,
                 "Experiment as canonical JSON (experiment.json of a result folder)")
      ->required();
  app.add_option("--results", options.results, "Result folder; what it holds already is not flown again")->required();
  app.add_option("--trial-order", coordinator.order,
                 "Order in which trials are handed out; results do not depend on it")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, TrialOrder>{{"canonical", TrialOrder::canonical}, {"shuffled", TrialOrder::shuffled}}));
  app.add_option("--fail-fast", coordinator.fail_fast,
                 "Stop after this many failed trials; 0: fly the rest, then report")
      ->check(aloft::runtime::whole_number(0, 1'000'000'000))
      ->capture_default_str();
  app.add_option_function<double>("--heartbeat-timeout", seconds_into(coordinator.heartbeat_timeout),
                                  "Silence in seconds after which a worker's trials go to others [3]")
      ->check(aloft::runtime::number(0.5, 3600));
  app.add_option_function<double>("--claim-timeout", seconds_into(coordinator.unclaimed_timeout),
                                  "Time in seconds in which a worker must show that it flies a trial it was given [5]")
      ->check(aloft::runtime::number(0.5, 3600));
  app.add_option_function<double>(
         "--look-around", seconds_into(options.look_around),
         "Time in seconds to listen for another coordinator of the run on another machine before the start [0.5]")
      ->check(aloft::runtime::number(0, 60));
  app.add_option("--give-up-after", options.give_up_after_s,
                 "Time in seconds without any worker that ends the run; 0: never")
      ->check(aloft::runtime::number(0, 1e9))
      ->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  ServiceOptions options;
  return aloft::runtime::run_service(
      argc, argv,
      {"aloft-coordinator", "Hands out the trials of an experiment to workers until every flight is stored.", false},
      [&options](CLI::App& app) { declare(app, options); },
      [&options](aloft::runtime::Service& service) { aloft::coordinator::coordinate(service, options); });
}
