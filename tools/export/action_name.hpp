#pragma once

#include <array>
#include <string_view>

#include "common/agents/observation.hpp"

namespace aloft::exports {

[[nodiscard]] inline std::string_view action_name(agents::Action action) {
  constexpr std::array<std::string_view, 5> names{"none", "down", "hold", "up", "absolute"};
  return names.at(static_cast<std::size_t>(action));
}

}  // namespace aloft::exports
