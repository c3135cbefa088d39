#include "common/agents/registry.hpp"
#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

std::unique_ptr<Agent> refuse_external(const Parameters& /*parameters*/) {
  throw InputError(
      "an agent of type 'external' is a program of your own that speaks Aloft's IDL, and cannot be flown inside this "
      "process; run over DDS (without --in-process) and start your program with the agent's name");
}

/// The experiment declares the agent's privilege, so that its results can be marked.
std::vector<std::string> tier_names() {
  std::vector<std::string> names;
  for (const PrivilegeTier& tier : privilege_tiers()) names.emplace_back(tier.name);
  return names;
}

const bool external_registered = register_agent(
    {.name = "external",
     .description = "A program of your own that answers over DDS with our IDL.",
     .foreign = true,
     .parameters = {choice_parameter("privilege", "none", tier_names(),
                                     "What it may see beyond what the UAV reports; results are marked.")},
     .make = refuse_external});

}  // namespace
}  // namespace aloft::agents
