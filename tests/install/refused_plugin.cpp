// Plugins that must be refused, one per REASON.
#include <stdexcept>

#include "common/agents/plugin.hpp"

namespace {

using namespace aloft::agents;  // NOLINT(google-build-using-namespace): a test of agents

[[maybe_unused]] std::unique_ptr<Agent> make(const aloft::Parameters& /*parameters*/) {
  return nullptr;
}

[[maybe_unused]] std::vector<AgentType> agents() {
#if defined(THROWS)
  throw std::runtime_error("the model is missing");
#elif defined(THROWS_A_NUMBER)
  throw 1;
#elif defined(TAKEN_NAME)
  return {{.name = "min-height", .make = make}};
#elif defined(BAD_NAME)
  return {{.name = "Min Height", .make = make}};
#elif defined(NO_MAKE)
  return {{.name = "mine"}};
#else
  return {{.name = "mine", .make = make}};
#endif
}

}  // namespace

#if defined(OTHER_INTERFACE)
extern "C" const Plugin aloft_plugin;
const Plugin aloft_plugin{plugin_interface + 1, plugin_layout, agents};
#elif defined(OTHER_LAYOUT)
extern "C" const Plugin aloft_plugin;
const Plugin aloft_plugin{plugin_interface, plugin_layout + 1, agents};
#elif defined(UNKNOWN_SYMBOL)
void function_of_a_later_aloft();
const bool called = (function_of_a_later_aloft(), true);
ALOFT_PLUGIN(agents);
#elif !defined(NO_PLUGIN)
ALOFT_PLUGIN(agents);
#endif
