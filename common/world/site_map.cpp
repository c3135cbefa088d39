#include "common/world/site_map.hpp"

#include "common/base/limits.hpp"
#include "common/base/random.hpp"

namespace aloft::world {

const std::vector<ParameterSpec>& site_map_parameters() {
  static const std::vector<ParameterSpec> table = [] {
    std::vector<ParameterSpec> all{
        number_parameter("site_map_error_m", 0.0, 0.0, 1000.0,
                         "Site map: standard deviation of its positions, per axis."),
        number_parameter("site_map_missing", 0.0, 0.0, 0.9, "Site map: share of the base stations that it lacks."),
        integer_parameter("site_map_route_points", 0, 0, limits::steps,
                          "Site map: points of the route ahead that are told at a time; 0: all."),
    };
    for (ParameterSpec& spec : all) spec.default_is_implied = true;
    return all;
  }();
  return table;
}

SiteMap draw_site_map(const Parameters& world, const std::vector<Position>& base_stations,
                      const std::vector<double>& azimuth_deg, std::uint64_t seed, std::uint32_t trial) {
  SiteMap map;
  map.position_error_m = world.number("site_map_error_m");
  map.missing = world.number("site_map_missing");
  map.route_points = static_cast<std::uint32_t>(world.integer("site_map_route_points"));
  RandomStream errors(seed, trial, "site map errors");
  RandomStream missing(seed, trial, "missing sites");
  for (std::size_t k = 0; k < base_stations.size(); ++k) {
    const double x_error = errors.normal();
    const double y_error = errors.normal();
    if (missing.uniform() < map.missing) continue;
    map.sites.push_back(
        {static_cast<std::int32_t>(k),
         {base_stations[k].x_m + map.position_error_m * x_error, base_stations[k].y_m + map.position_error_m * y_error},
         azimuth_deg.empty() ? 0.0 : azimuth_deg[k]});
  }
  return map;
}

}  // namespace aloft::world
