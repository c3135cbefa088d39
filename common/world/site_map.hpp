#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::world {

/// The parameters of a site map. Implied: worlds from before there were site maps name none.
[[nodiscard]] const std::vector<ParameterSpec>& site_map_parameters();

/// The site map of one trial: errors from the stream "site map errors", two normal numbers per base station, and
/// "missing sites", one uniform number each. So maps that differ in one parameter share everything else. `azimuth_deg`
/// per base station, or empty. `world` holds at least the keys of site_map_parameters().
[[nodiscard]] SiteMap draw_site_map(const Parameters& world, const std::vector<Position>& base_stations,
                                    const std::vector<double>& azimuth_deg, std::uint64_t seed, std::uint32_t trial);

}  // namespace aloft::world
