#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>
#include <string>

#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"
#include "services/runtime/notifier.hpp"

namespace aloft::runtime {

/// Facts about one executable.
struct ServiceInfo {
  std::string name;         ///< e.g. "aloft-channel": "aloft-" and, in a secured run, its role
  std::string description;  ///< one sentence
  bool in_worker = false;   ///< takes --worker
};

/// What every service is given. Options that all have in common are parsed already.
struct Service {
  bus::BusOptions bus;
  StopSignal& stop;
  Notifier& notifier;  ///< reports the service's state to a service manager
};

/// Makes a service of two functions: `add_options` declares further command-line options (may be empty), `run` does the
/// work until it is done or `stop` is requested. Parses --run, --worker, the options of bus_flags.hpp,
/// --log-dir, --log-level, --verbose and --die-with-parent; sets up the log and the signals; turns errors into messages
/// and exit codes (base/error.hpp).
int run_service(int argc, char** argv, const ServiceInfo& info, const std::function<void(CLI::App&)>& add_options,
                const std::function<void(Service&)>& run);

}  // namespace aloft::runtime
