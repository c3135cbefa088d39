#include "common/agents/registry.hpp"
#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

std::unique_ptr<Agent> refuse_external(const Parameters& /*parameters*/) {
  throw InputError(
      "an agent of type 'external' is a program of your own that speaks Aloft's IDL, and cannot be flown inside this "
      "process; run over DDS (without --in-process) and start your program with the agent's name");
}

const bool external_registered =
    register_agent({.name = "external",
                    .description = "A program of your own that answers over DDS with our IDL.",
                    .foreign = true,
                    .make = refuse_external});

}  // namespace
}  // namespace aloft::agents
