#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::agents {

/// What an operator knows of a flight beforehand: the site map and the planned route. Only for agents with
/// Privilege::site_map.
struct SiteMap {
  std::uint32_t step = 0;             ///< of the report that follows
  std::optional<Parameters> radio;    ///< of the world: every key of generated_world_parameters(); unset in an update
  world::SiteMap known;               ///< without sites in updates: they are as before
  std::vector<world::Position> route; /**< [i]: where the result of step + 1 + i is read; all that is told so far, or at
                                         least one point before the last report */
};

}  // namespace aloft::agents
