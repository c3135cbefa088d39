#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aloft::agents {

/// Loads a shared object made with plugin.hpp and registers its agents, which then are like those that are built in.
/// Their parameter "plugin_sha256" names the file's content in experiments and results; an agent whose experiment names
/// another one cannot be made. Throws InputError with the path and the reason if it is no plugin, was built for another
/// interface, throws, or has an agent that cannot be registered. Only while no other thread runs.
void load_plugin(const std::filesystem::path& file);

/// A file that was loaded, and the names of its agents.
struct LoadedPlugin {
  std::filesystem::path file;  ///< absolute
  std::vector<std::string> agents;
};

/// In the order of loading.
[[nodiscard]] std::span<const LoadedPlugin> loaded_plugins();

/// The plugin that an agent's type comes from; nullptr if it is built in.
[[nodiscard]] const LoadedPlugin* plugin_of(std::string_view type);

}  // namespace aloft::agents
