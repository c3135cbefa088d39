#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/agents/registry.hpp"

namespace aloft::agents {

/// The number of the plugin interface: rises with every change of the headers that plugins include.
inline constexpr std::uint32_t plugin_interface = 4;

/// Differs between compilations that lay out the exchanged types differently: another standard library, its debug mode,
/// or headers that were changed without a new number.
inline constexpr std::uint64_t plugin_layout = [] {
  std::uint64_t hash = 0;
  for (const std::size_t part :
       {sizeof(AgentType), sizeof(ParameterSpec), sizeof(Parameters), sizeof(FlightInfo), sizeof(Observation),
        sizeof(SiteMap), sizeof(HeightProfile), sizeof(Command), sizeof(Look)})
    hash = hash * 1009 + part;
#ifdef _GLIBCXX_USE_CXX11_ABI
  hash = hash * 2 + _GLIBCXX_USE_CXX11_ABI;
#endif
  return hash;
}();

/// What a plugin exports, under the name aloft_plugin. The numbers come first, in every version: they are read before
/// anything else is used.
struct Plugin {
  std::uint32_t interface = 0;
  std::uint64_t layout = 0;
  std::vector<AgentType> (*agents)() = nullptr;  ///< may throw; called once
};

}  // namespace aloft::agents

/// Once per plugin, outside of namespaces; `function` returns its agents.
#define ALOFT_PLUGIN(function)                                                                                  \
  extern "C" {                                                                                                  \
  [[gnu::visibility("default")]] extern const ::aloft::agents::Plugin aloft_plugin;                             \
  const ::aloft::agents::Plugin aloft_plugin{::aloft::agents::plugin_interface, ::aloft::agents::plugin_layout, \
                                             function};                                                         \
  }                                                                                                             \
  static_assert(true)
