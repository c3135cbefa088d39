#pragma once

#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

/// From what an operator knows of a world to what Scene needs. `world`: every key of generated_world_parameters().
namespace aloft::radio {

/// The city with base stations at these sites, and without buildings.
[[nodiscard]] world::City city_of(const Parameters& world, const std::vector<world::Site>& sites);

/// The azimuths of the sites' sector antennas, in half turns; none if the world's base stations have others.
[[nodiscard]] std::vector<double> sector_half_turns(const Parameters& world, const std::vector<world::Site>& sites);

}  // namespace aloft::radio
