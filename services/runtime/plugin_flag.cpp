#include "services/runtime/plugin_flag.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "common/agents/load_plugin.hpp"

namespace aloft::runtime {

void add_plugin_flag(CLI::App& app, std::vector<std::string>& files) {
  app.add_option("--plugin", files, "Shared object with agents of your own (docs/plugins.md); repeatable")
      ->type_name("FILE")
      ->expected(1)
      ->take_all();
}

std::vector<std::string> plugin_arguments() {
  std::vector<std::string> arguments;
  for (const auto& plugin : agents::loaded_plugins())
    arguments.insert(arguments.end(), {"--plugin", plugin.file.string()});
  return arguments;
}

}  // namespace aloft::runtime
