#include <CLI/CLI.hpp>

#include "services/metrics/metrics_service.hpp"
#include "services/runtime/flag_checks.hpp"

int main(int argc, char** argv) {
  aloft::metrics::ServiceOptions options;
  return aloft::runtime::run_service(
      argc, argv, {"aloft-metrics", "Stores every finished flight of a run in a result folder.", false},
      [&options](CLI::App& app) {
        app.add_option("--experiment", options.experiment,
                       "Experiment as canonical JSON (experiment.json of a result folder)")
            ->required();
        app.add_option("--results", options.results, "Result folder, made or continued")->required();
        app.add_option("--http-port", options.http_port,
                       "Serve /healthz, /status and /metrics there; 0: any free port (see the log); none: do not")
            ->check(aloft::runtime::whole_number(0, 65535));
        app.add_option("--http-address", options.http_address,
                       "Address of this machine for --http-port; 0.0.0.0: all, so that other hosts can read them")
            ->check(CLI::ValidIPV4)
            ->capture_default_str();
        app.add_option("--http-host", options.http_hosts,
                       "Further names, separated by commas, under which HTTP requests may come, e.g. of a service; "
                       "localhost and addresses always may [none]")
            ->delimiter(',');
        app.add_flag("--summary", options.summary,
                     "Outlive a coordinator that is stopped; write summary.json and summary.csv when the run is over");
      },
      [&options](aloft::runtime::Service& service) { aloft::metrics::collect(service, options); });
}
