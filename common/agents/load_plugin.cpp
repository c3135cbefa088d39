#include "common/agents/load_plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/agents/plugin.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/read_file.hpp"

namespace aloft::agents {
namespace {

namespace fs = std::filesystem;

constexpr const char* digest_parameter = "plugin_sha256";

std::vector<LoadedPlugin>& loaded() {
  static std::vector<LoadedPlugin> plugins;
  return plugins;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw InputError("--plugin '{}': {}", file.string(), why);
}

/// The reason that the loader gives, without the path in front of it.
std::string loader_error(const fs::path& file) {
  const char* text = dlerror();
  std::string reason = text == nullptr ? "unknown reason" : text;
  if (reason.starts_with(file.string() + ": ")) reason.erase(0, file.string().size() + 2);
  return reason;
}

/// Never unloaded: its agents can be anywhere.
const Plugin& open_plugin(const fs::path& file) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const std::string reason = loader_error(file);
    if (reason.find("undefined symbol") != std::string::npos)
      refuse(file, fmt::format("needs what this program does not have ({}); build it with the headers of this version "
                               "(interface {}), and link other libraries that it uses into it",
                               reason, plugin_interface));
    refuse(file,
           fmt::format("cannot be loaded: {}; name a shared object that was built as docs/plugins.md shows", reason));
  }
  const auto* plugin = static_cast<const Plugin*>(dlsym(library, "aloft_plugin"));
  if (plugin == nullptr)
    refuse(file, "is no plugin: it does not export aloft_plugin; end its source with ALOFT_PLUGIN(function)");
  return *plugin;
}

void check_built_for_this(const fs::path& file, const Plugin& plugin) {
  if (plugin.interface != plugin_interface)
    refuse(file, fmt::format("was built for interface {} of plugins, but this program has interface {}; build it with "
                             "the headers of this version",
                             plugin.interface, plugin_interface));
  if (plugin.layout != plugin_layout || plugin.agents == nullptr)
    refuse(file,
           "was compiled with another layout of the types that it shares with this program; build it with the "
           "headers of this version and the system's compiler, without _GLIBCXX_DEBUG");
}

std::vector<AgentType> agents_of(const fs::path& file, const Plugin& plugin) {
  std::string why;
  try {
    return plugin.agents();
  } catch (const std::exception& error) {
    why = error.what();
  } catch (...) {
    why = "something that is no std::exception";
  }
  refuse(file, fmt::format("throws while it names its agents: {}", why));
}

void check_type(const fs::path& file, const AgentType& type) {
  const std::string which = fmt::format("its agent '{}' ", type.name);
  if (!is_agent_name(type.name))
    refuse(file, which + "has a name that is not allowed; use 1 to 64 characters of a-z, 0-9, '.', '-'");
  const std::span<const AgentType> known = agent_types();
  if (std::any_of(known.begin(), known.end(), [&](const AgentType& other) { return other.name == type.name; }))
    refuse(file, which + "has the name of another agent; choose another name");
  if (!type.make) refuse(file, which + "has no function make");
  if (type.foreign || type.relay)
    refuse(file, which + "is declared foreign or a relay, which only built-in agents are");
}

/// Ties the agent to the content of its file.
void add_digest(AgentType& type, const fs::path& file, const std::string& digest) {
  type.parameters.push_back(
      text_parameter(digest_parameter, digest, "SHA-256 of the plugin that the agent comes from; set by itself."));
  type.make = [make = std::move(type.make), file, digest](const Parameters& parameters) {
    if (parameters.text(digest_parameter) != digest)
      throw InputError(
          fmt::format("the experiment was made with another build of the plugin '{}': its SHA-256 is {}, not {}; "
                      "load that build, or fly a new experiment",
                      file.string(), digest, parameters.text(digest_parameter)));
    return make(parameters);
  };
}

}  // namespace

void load_plugin(const fs::path& given) {
  const fs::path file = fs::absolute(given).lexically_normal();
  if (std::any_of(loaded().begin(), loaded().end(), [&](const LoadedPlugin& one) { return one.file == file; })) return;
  const std::string digest = sha256_hex(read_file(file));
  const Plugin& plugin = open_plugin(file);
  check_built_for_this(file, plugin);
  LoadedPlugin entry{file, {}};
  for (AgentType& type : agents_of(file, plugin)) {
    entry.agents.push_back(type.name);
    check_type(file, type);
    add_digest(type, file, digest);
    register_agent(std::move(type));
  }
  loaded().push_back(std::move(entry));
}

std::span<const LoadedPlugin> loaded_plugins() {
  return loaded();
}

const LoadedPlugin* plugin_of(std::string_view type) {
  for (const LoadedPlugin& plugin : loaded())
    if (std::find(plugin.agents.begin(), plugin.agents.end(), type) != plugin.agents.end()) return &plugin;
  return nullptr;
}

}  // namespace aloft::agents
