#include "common/agents/agent.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aloft::agents {

std::optional<Introspection> showable(const std::optional<Introspection>& thoughts) noexcept {
  const auto finite = [](double value) { return std::isfinite(value); };
  const bool all_finite = thoughts && finite(thoughts->epsilon) && finite(thoughts->loss) &&
                          std::ranges::all_of(thoughts->q_values, finite);
  return all_finite ? thoughts : std::nullopt;
}

void Agent::survey(const SiteMap& /*map*/) {
  throw std::logic_error("an agent without the privilege was given the site map");
}

void Agent::foresee(const HeightProfile& /*profile*/) {
  throw std::logic_error("an agent without the privilege was shown quality that it has not measured");
}

}  // namespace aloft::agents
