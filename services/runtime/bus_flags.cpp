#include "services/runtime/bus_flags.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "services/runtime/flag_checks.hpp"

namespace aloft::runtime {

void add_bus_flags(CLI::App& app, bus::BusOptions& options) {
  app.add_option("--domain", options.domain, "DDS domain")->check(whole_number(0, 101))->capture_default_str();
  app.add_option("--interface", options.interfaces,
                 "Network interface to use, by address or name; needed to reach other hosts; repeatable")
      ->expected(1)
      ->take_all()
      ->capture_default_str();
  app.add_option("--discovery-server", options.discovery_server,
                 "ADDRESS:PORT of the run's discovery server, where multicast does not reach [multicast]");
  app.add_option("--secure", options.secure,
                 "Folder with the keys of this process's role (aloft keys); all processes of a run, or none")
      ->check([](const std::string&) { return bus::secured_run_objection(); });
}

std::vector<std::string> bus_arguments(const bus::BusOptions& options) {
  std::vector<std::string> arguments{"--run", options.run, "--domain", std::to_string(options.domain)};
  for (const std::string& interface : options.interfaces) arguments.insert(arguments.end(), {"--interface", interface});
  if (!options.discovery_server.empty())
    arguments.insert(arguments.end(), {"--discovery-server", options.discovery_server});
  if (!options.secure.empty()) arguments.insert(arguments.end(), {"--secure", options.secure.string()});
  return arguments;
}

}  // namespace aloft::runtime
