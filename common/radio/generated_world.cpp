#include "common/radio/generated_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/radio/radio_model.hpp"
#include "common/radio/serving_rule.hpp"
#include "common/world/city.hpp"
#include "common/world/route.hpp"
#include "common/world/site_map.hpp"

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

/// A named set of defaults: its differences from the tables.
struct Preset {
  std::string name;
  Json changes;
};

/// To four digits.
double watts(double power_dbm) {
  return std::round(1e4 * std::pow(10.0, power_dbm / 10.0 - 3.0)) / 1e4;
}

/// A network as 3GPP assumes it for studies of UAVs: a hexagonal grid with this distance of sites, 10 MHz, long-term
/// averages instead of fast fading, 256-QAM at most (TS 38.214 Table 5.1.3.1-2: 8 bit at a code rate of 948/1024).
Json network(std::string_view model, double site_distance_m, const Json& changes) {
  const double site_km2 = 0.5 * std::numbers::sqrt3 * site_distance_m * site_distance_m / 1e6;
  Json all{{"propagation", model},
           {"deployment", "hexagonal"},
           {"bs_density_per_km2", std::round(1e4 / site_km2) / 1e4},
           {"building_density_per_km2", 0.0},
           {"cells_per_site", "three"},
           {"bs_antenna", "3gpp"},
           {"bs_downtilt_deg", 10.0},
           {"fading", "none"},
           {"height_max_m", 300.0},
           {"bandwidth_mhz", 10.0},
           {"noise_figure_db", 9.0},
           {"spectral_efficiency_max", 7.4063}};
  all.update(changes);
  return all;
}

/// The same number of sites per km2 at random places.
Json poisson(Json network) {
  network["deployment"] = "poisson";
  return network;
}

const std::vector<Preset>& presets() {
  static const Json urban_macro = network("uma-av", 500.0, {{"tx_power_w", watts(46.0)}});
  static const Json urban_micro = network("umi-av", 200.0, {{"tx_power_w", watts(41.0)}, {"window_m", 2000.0}});
  static const Json rural_macro =
      network("rma-av", 1732.0,
              {{"tx_power_w", watts(46.0)}, {"window_m", 8000.0}, {"carrier_ghz", 0.7}, {"bs_downtilt_deg", 6.0}});
  static const std::vector<Preset> all{
      {"published", Json::object()},
      {"paper-text",
       {{"los_ray", "geometric"},
        {"uav_antenna", "omnidirectional"},
        {"bs_antenna", "sector"},
        {"path_distance", "horizontal"},
        {"fading", "none"},
        {"serving_selection", "best-of-all"}}},
      {"geometric",
       {{"los_ray", "geometric"},
        {"building_height_distribution", "rayleigh"},
        {"building_height_mean_m", 25.0663},  // of a Rayleigh distribution with scale 20 m
        {"fading", "correlated"},
        {"fading_correlation", 1.0}}},
      {"3gpp-uma", urban_macro},
      {"3gpp-umi", urban_micro},
      {"3gpp-rma", rural_macro},
      {"3gpp-uma-poisson", poisson(urban_macro)},
      {"3gpp-umi-poisson", poisson(urban_micro)},
      {"3gpp-rma-poisson", poisson(rural_macro)},
  };
  return all;
}

const Preset& preset_named(std::string_view name) {
  return *std::ranges::find(presets(), name, &Preset::name);
}

/// The channel model of worlds that name none.
std::string model_of(const Preset& preset) {
  return preset.changes.value("propagation", std::string(default_link_model));
}

ParameterSpec preset_parameter() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.push_back(preset.name);
  return choice_parameter("preset", "published", std::move(names), "Named set of defaults for the other parameters.");
}

/// Implied, because worlds that were resolved before there was a choice name no model.
ParameterSpec propagation_parameter() {
  std::vector<std::string> names;
  for (const LinkModelType& model : link_model_types()) names.push_back(model.name);
  ParameterSpec spec = choice_parameter("propagation", std::string(default_link_model), std::move(names),
                                        "Channel model: line of sight, and mean gain with and without it.");
  spec.default_is_implied = true;
  return spec;
}

std::vector<ParameterSpec> table_with(std::span<const LinkModelType> models, bool handover) {
  std::vector<ParameterSpec> all{preset_parameter()};
  const auto append = [&all](const std::vector<ParameterSpec>& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  append(world::city_parameters());
  append(world::route_parameters());
  append(height_parameters());
  all.push_back(propagation_parameter());
  for (const LinkModelType& model : models)
    for (const ParameterSpec& spec : model.parameters)  // models can share one
      if (std::ranges::find(all, spec.name, &ParameterSpec::name) == all.end()) all.push_back(spec);
  append(radio_parameters());
  all.push_back(serving_parameter());
  if (handover) append(a3_parameters());
  append(world::site_map_parameters());
  return all;
}

/// The changes of the model and the preset to those parameters that the table has; the preset's last.
Json defaults_of(const LinkModelType& model, const Preset& preset, std::span<const ParameterSpec> table) {
  Json defaults = model.defaults;
  for (const ParameterSpec& spec : table)
    if (preset.changes.contains(spec.name)) defaults[spec.name] = preset.changes[spec.name];
  return defaults;
}

bool is_multiple(double value, double of) {
  const double ratio = value / of;
  return std::fabs(ratio - std::round(ratio)) <= 1e-9 * std::max(1.0, ratio);
}

void require(bool holds, std::string_view where, std::string_view key, const std::string& reason) {
  if (!holds) throw InputError("{}{}{}: {}", where, where.empty() ? "" : ".", key, reason);
}

/// With this probability, 100,000 draws in a row, which take a millisecond, all fail with a probability of 10^-13.
constexpr double least_probability_of_enough = 3e-4;

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
  require(world::cells_per_site(world) == 1 || world.text("bs_antenna") == "3gpp", where, "cells_per_site",
          fmt::format("three cells need antennas with azimuths of their own; set bs_antenna to \"3gpp\", not \"{}\"",
                      world.text("bs_antenna")));
  const double sites = world.number("bs_density_per_km2") * std::pow(world.number("window_m") / 1000.0, 2);
  require(world::cells_per_site(world) * (sites + 20.0 * std::sqrt(sites)) <= limits::base_stations, where,
          "cells_per_site",
          fmt::format("three at each of {:.0f} sites can be more base stations than the {} that are possible; lower "
                      "bs_density_per_km2 or window_m",
                      sites, limits::base_stations));
  const double enough = world::probability_of_enough_stations(world);
  require(
      enough > 0.0, where, "min_base_stations",
      fmt::format("{} is more than a hexagonal grid with bs_density_per_km2 {} has in window_m {}; raise the density "
                  "or the window, or ask for fewer",
                  world.integer("min_base_stations"), world.number("bs_density_per_km2"), world.number("window_m")));
  require(enough >= least_probability_of_enough, where, "min_base_stations",
          fmt::format("only one in {:.0g} cities has {} or more base stations with bs_density_per_km2 {} and window_m "
                      "{}; raise the density or the window, or ask for fewer",
                      1.0 / enough, world.integer("min_base_stations"), world.number("bs_density_per_km2"),
                      world.number("window_m")));
}

void refuse_a3_parameters(const Json& given, std::string_view where) {
  for (const ParameterSpec& spec : a3_parameters())
    require(!given.contains(spec.name), where, spec.name,
            "only worlds with serving \"a3\" have handovers; set that, or leave it out");
}

void check_sync(const Parameters& world, std::string_view where) {
  require(world.number("qin_db") >= world.number("qout_db"), where, "qin_db",
          fmt::format("{} is below qout_db {}; use at least that", world.number("qin_db"), world.number("qout_db")));
}

}  // namespace

const std::vector<ParameterSpec>& generated_world_parameters() {
  static const std::vector<ParameterSpec> table = table_with(link_model_types(), true);
  return table;
}

std::vector<ParameterSpec> generated_world_parameters(const LinkModelType& model, bool handover) {
  return table_with(std::span(&model, 1), handover);
}

std::vector<std::string> presets_with(const LinkModelType& model) {
  std::vector<std::string> names;
  for (const Preset& preset : presets())
    if (model_of(preset) == model.name) names.push_back(preset.name);
  return names;
}

Parameters resolve_generated_world(const Json& given, std::string_view where) {
  // Reports every error in what was given before the preset is merged into it.
  const Parameters checked(generated_world_parameters(), given, where);
  const Preset& preset = preset_named(checked.text("preset"));
  const LinkModelType& model =
      link_model_type(given.contains("propagation") ? checked.text("propagation") : model_of(preset));
  const bool handover = a3_rules(checked).has_value();
  if (!handover) refuse_a3_parameters(given, where);
  std::vector<ParameterSpec> table = generated_world_parameters(model, handover);
  Json merged = defaults_of(model, preset, table);
  for (ParameterSpec& spec : table)  // where the preset says otherwise, the table's default must be written
    if (merged.contains(spec.name)) spec.default_is_implied = false;
  merged.update(given);
  if (!merged.contains("route_offset_max_m"))
    merged["route_offset_max_m"] = std::min(1000.0, checked.number("height_step_m"));
  Parameters world(table, merged, where);
  check_heights(world, where);
  check_route_and_stations(world, where);
  if (handover) check_sync(world, where);
  if (model.check) model.check(world, where);
  return world;
}

}  // namespace aloft::radio
