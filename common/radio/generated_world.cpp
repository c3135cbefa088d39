#include "common/radio/generated_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/radio/reading.hpp"
#include "common/world/city.hpp"
#include "common/world/route.hpp"

namespace aloft::radio {
namespace {

using Json = nlohmann::json;

const std::vector<ParameterSpec>& height_parameters() {
  static const std::vector<ParameterSpec> table = {
      number_parameter("height_min_m", 40.0, 1.0, 10'000.0, "Lowest height of the UAV; flights start there."),
      number_parameter("height_max_m", 240.0, 1.0, 10'000.0, "Greatest height of the UAV."),
      number_parameter("height_step_m", 10.0, 0.1, 1000.0, "The paper's d: change of height by one action."),
      number_parameter("height_resolution_m", 1.0, 0.1, 1000.0,
                       "Distance of heights for agents that see all of them, or may jump."),
  };
  return table;
}

const std::vector<ParameterSpec>& radio_parameters() {
  static const std::vector<ParameterSpec> table = {
      choice_parameter("los_ray", "published", {"published", "geometric"},
                       "Ray of line of sight: reversed as in the published simulator, or from the UAV to the mast."),
      choice_parameter("uav_antenna", "directional", {"directional", "omnidirectional"},
                       "UAV antenna: a beam that points at the base station, or all directions with gain 1."),
      number_parameter("uav_beamwidth_deg", 45.0, 1.0, 170.0, "Beamwidth of the directional UAV antenna."),
      choice_parameter("bs_antenna", "array", {"array", "sector"},
                       "Base station antenna: vertical array of 8 elements, or one rectangular sector, steered at the "
                       "UAV it serves, and else at a fixed random azimuth."),
      number_parameter("bs_beamwidth_deg", 45.0, 1.0, 170.0, "Beamwidth of a base station's sector."),
      choice_parameter("path_distance", "slant", {"slant", "horizontal"}, "Distance that path loss counts."),
      number_parameter("path_exponent_los", 2.1, 1.0, 8.0, "Path loss exponent with line of sight."),
      number_parameter("path_exponent_nlos", 4.0, 1.0, 8.0, "Path loss exponent without line of sight."),
      choice_parameter("fading", "independent", {"independent", "none", "correlated"},
                       "Rayleigh fading per route point, height, candidate and transmitter: independent, none, or "
                       "correlated over height."),
      number_parameter("fading_correlation", 1.0, 0.0, 1.0,
                       "Fading `correlated`: correlation of amplitudes 1 m of height apart; 1 is constant."),
      choice_parameter("serving_selection", "best-of-candidates", {"best-of-candidates", "best-of-all"},
                       "Serving cell: best SINR of the candidates, or of all base stations."),
      integer_parameter("candidates", 5, 1, 50, "Candidates: so many base stations with the largest received power."),
      integer_parameter("neighbours", 4, 0, static_cast<double>(max_neighbours),
                        "Neighbours whose SINR the UAV reports, strongest first."),
      number_parameter("interferer_distance_max_m", 3000.0, 1.0, 20'000.0,
                       "Farthest interferer while the directional UAV antenna points near the horizon."),
      number_parameter("tx_power_w", 40.0, 0.001, 1000.0, "Transmit power of every base station."),
      number_parameter("carrier_ghz", 3.5, 0.1, 100.0, "Carrier frequency."),
      number_parameter("bandwidth_mhz", 20.0, 0.1, 2000.0, "Bandwidth that noise is counted in."),
      number_parameter("noise_figure_db", 10.0, 0.0, 30.0, "Noise figure of the receiver."),
  };
  return table;
}

/// What a preset changes against `published`.
Json preset_defaults(const std::string& preset) {
  if (preset == "paper-text")
    return {{"los_ray", "geometric"}, {"uav_antenna", "omnidirectional"},
            {"bs_antenna", "sector"}, {"path_distance", "horizontal"},
            {"fading", "none"},       {"serving_selection", "best-of-all"}};
  if (preset == "geometric")  // the mean of a Rayleigh distribution with scale 20 m is 25.0663 m
    return {{"los_ray", "geometric"},
            {"building_height_distribution", "rayleigh"},
            {"building_height_mean_m", 25.0663},
            {"fading", "correlated"},
            {"fading_correlation", 1.0}};
  return Json::object();
}

bool is_multiple(double value, double of) {
  const double ratio = value / of;
  return std::fabs(ratio - std::round(ratio)) <= 1e-9 * std::max(1.0, ratio);
}

void require(bool holds, std::string_view where, std::string_view key, const std::string& reason) {
  if (!holds) throw InputError(fmt::format("{}{}{}: {}", where, where.empty() ? "" : ".", key, reason));
}

/// Of 100,000 draws, one in 10^13 series of them would have no city; and this many draws take a millisecond.
constexpr double least_probability_of_enough = 3e-4;

/// Combinations that contradict each other.
void check_heights(const Parameters& world, std::string_view where) {
  const double low_m = world.number("height_min_m");
  const double high_m = world.number("height_max_m");
  const double step_m = world.number("height_step_m");
  const double resolution_m = world.number("height_resolution_m");
  const double base_m = world.number("base_station_height_m");
  require(high_m >= low_m, where, "height_max_m",
          fmt::format("{} is below height_min_m {}; use at least that", high_m, low_m));
  require(is_multiple(high_m - low_m, step_m), where, "height_step_m",
          fmt::format("the range from height_min_m {} to height_max_m {} is no multiple of {}; change one of the three",
                      low_m, high_m, step_m));
  require(is_multiple(step_m, resolution_m), where, "height_resolution_m",
          fmt::format("{} does not divide height_step_m {}; use a whole fraction of it", resolution_m, step_m));
  require(std::round((high_m - low_m) / resolution_m) < limits::heights, where, "height_resolution_m",
          fmt::format("{} makes more than {} heights from {} to {} m; use a larger one", resolution_m, limits::heights,
                      low_m, high_m));
  require(
      low_m >= base_m, where, "height_min_m",
      fmt::format("{} is below base_station_height_m {}; the radio model holds at or above the masts", low_m, base_m));
}

void check_route_and_stations(const Parameters& world, std::string_view where) {
  const double start_m = world.number("route_start_x_m");
  const double end_m = start_m + world.number("route_spacing_m") * world.integer("steps");
  const double edge_m = 0.5 * world.number("window_m");
  require(start_m >= -edge_m && end_m <= edge_m, where, "route_start_x_m",
          fmt::format("the route from x = {} to {} m leaves the city, which ends at +-{} m; change route_start_x_m, "
                      "route_spacing_m, steps or window_m",
                      start_m, end_m, edge_m));
  require(world.number("route_offset_max_m") <= edge_m, where, "route_offset_max_m",
          fmt::format("{} is more than half of window_m", world.number("route_offset_max_m")));
  const int needed = std::max(world.integer("candidates"), world.integer("neighbours") + 1);
  require(world.integer("min_base_stations") >= needed, where, "min_base_stations",
          fmt::format("{} is too few for {} candidates and {} neighbours; use at least {}",
                      world.integer("min_base_stations"), world.integer("candidates"), world.integer("neighbours"),
                      needed));
  const double enough = world::probability_of_enough_stations(world);
  require(enough >= least_probability_of_enough, where, "min_base_stations",
          fmt::format("only one in {:.0g} cities has {} or more base stations with bs_density_per_km2 {} and window_m "
                      "{}; raise the density or the window, or ask for fewer",
                      1.0 / enough, world.integer("min_base_stations"), world.number("bs_density_per_km2"),
                      world.number("window_m")));
}

}  // namespace

const std::vector<ParameterSpec>& generated_world_parameters() {
  static const std::vector<ParameterSpec> table = [] {
    std::vector<ParameterSpec> all{choice_parameter("preset", "published", {"published", "paper-text", "geometric"},
                                                    "Named set of defaults for the other parameters.")};
    for (const auto* part :
         {&world::city_parameters(), &world::route_parameters(), &height_parameters(), &radio_parameters()})
      all.insert(all.end(), part->begin(), part->end());
    return all;
  }();
  return table;
}

Parameters resolve_generated_world(const Json& given, std::string_view where) {
  const auto& table = generated_world_parameters();
  const Parameters checked(table, given, where);  // every error in what was given, before anything is merged
  Json merged = preset_defaults(checked.text("preset"));
  merged.update(given);
  if (!merged.contains("route_offset_max_m"))
    merged["route_offset_max_m"] = std::min(1000.0, checked.number("height_step_m"));
  Parameters world(table, merged, where);
  check_heights(world, where);
  check_route_and_stations(world, where);
  return world;
}

}  // namespace aloft::radio
