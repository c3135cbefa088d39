#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "common/bus/participant.hpp"

namespace aloft::runtime {

/// Declares how a process reaches the others: --domain, --interface, --discovery-server, --secure. Every process takes
/// them.
void add_bus_flags(CLI::App& app, bus::BusOptions& options);

/// The arguments that put a child process in the same place: the flags above and --run.
[[nodiscard]] std::vector<std::string> bus_arguments(const bus::BusOptions& options);

}  // namespace aloft::runtime
