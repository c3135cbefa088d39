#include "common/agents/agent.hpp"

#include <stdexcept>

namespace aloft::agents {

void Agent::foresee(const HeightProfile& /*profile*/) {
  throw std::logic_error("an agent without the privilege was shown quality that it has not measured");
}

}  // namespace aloft::agents
