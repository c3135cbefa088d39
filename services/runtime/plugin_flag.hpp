#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace aloft::runtime {

/// Declares --plugin, for all programs and commands that read experiments or results. The files are loaded by
/// agents::load_plugin once the command line has been read.
void add_plugin_flag(CLI::App& app, std::vector<std::string>& files);

/// The arguments that make a child process load the same plugins as this one.
[[nodiscard]] std::vector<std::string> plugin_arguments();

}  // namespace aloft::runtime
