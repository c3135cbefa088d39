#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/base/error.hpp"
#include "common/radio/aerial_link.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/radio/radio_model.hpp"
#include "common/world/city.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

struct LinkOptions {
  std::string model;
  double height_m = 0.0;
  double distance_m = 0.0;
  double carrier_ghz = 2.0;
  std::string format;
};

/// What a channel model says of one link.
struct LinkFacts {
  double base_station_height_m = 0.0;
  double p_los = 0.0;
  double path_loss_los_db = 0.0;
  double path_loss_nlos_db = 0.0;
  double shadow_los_db = 0.0;
  double shadow_nlos_db = 0.0;
  std::string note;  ///< where the numbers come from, or why they are not to be relied on
};

void check_range(std::string_view option, double value, double lowest, double highest, const LinkOptions& options) {
  if (!(value >= lowest && value <= highest))
    throw InputError("{} {:g}: {} is defined from {:g} to {:g}; give a value in this range", option, value,
                     options.model, lowest, highest);
}

LinkFacts of_standard(const LinkOptions& options, radio::AerialScenario scenario) {
  const radio::AerialScenarioFacts limits = radio::facts(scenario);
  check_range("--carrier", options.carrier_ghz, radio::aerial_carrier_min_ghz, limits.carrier_max_ghz, options);
  check_range("--height", options.height_m, radio::aerial_height_min_m, radio::aerial_height_max_m, options);
  check_range("--distance", options.distance_m, 0.0, limits.distance_max_m, options);
  const radio::AerialLink link{scenario, options.carrier_ghz, options.distance_m, options.height_m};
  return {.base_station_height_m = limits.base_station_height_m,
          .p_los = radio::line_of_sight_probability(link),
          .path_loss_los_db = radio::path_loss_db(link, true),
          .path_loss_nlos_db = radio::path_loss_db(link, false),
          .shadow_los_db = radio::shadowing_deviation_db(link, true),
          .shadow_nlos_db = radio::shadowing_deviation_db(link, false),
          .note = options.height_m > limits.aerial_above_m ? "3GPP TR 36.777, Annex B"
                                                           : "3GPP TR 38.901, below the heights of TR 36.777"};
}

constexpr int sampled_cities = 100;
constexpr int sampled_directions = 16;

/// The models of generated worlds know line of sight from the buildings alone: its probability is the share of links of
/// this length that have it, over many cities of the published preset and many directions.
LinkFacts of_generated_worlds(const LinkOptions& options, const radio::LinkModelType& type) {
  const Parameters world = radio::resolve_generated_world({{"propagation", type.name}}, "world");
  world::City city;
  city.base_station_height_m = world.number("base_station_height_m");
  check_range("--carrier", options.carrier_ghz, 0.1, 100.0, options);
  check_range("--height", options.height_m, city.base_station_height_m, 10'000.0, options);
  check_range("--distance", options.distance_m, 0.0, world.number("window_m"), options);
  for (int i = 0; i < sampled_directions; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.5) / sampled_directions;
    city.base_stations.push_back(
        {0.5 * options.distance_m * std::cos(angle), 0.5 * options.distance_m * std::sin(angle)});
  }
  LinkFacts facts;
  facts.base_station_height_m = city.base_station_height_m;
  int visible = 0;
  for (std::uint32_t trial = 0; trial < sampled_cities; ++trial) {
    world::draw_buildings(world, 1, trial, city);
    const auto model = type.make(world, city, 1, trial);
    for (std::uint32_t k = 0; k < sampled_directions; ++k) {
      const world::Position station = city.base_stations[k];
      const radio::LinkPlace link{{-station.x_m, -station.y_m}, k, options.distance_m};
      if (model->blocking_height_m(link) <= options.height_m) ++visible;
      for (const bool line_of_sight : {true, false}) {
        double gain = 0.0;
        model->mean_gain_row(link, line_of_sight, std::span(&options.height_m, 1), &gain);
        (line_of_sight ? facts.path_loss_los_db : facts.path_loss_nlos_db) =
            -10.0 * std::log10(gain * radio::near_field_gain(options.carrier_ghz * 1e9));
        model->shadowing_row(link, line_of_sight, std::span(&options.height_m, 1),
                             line_of_sight ? &facts.shadow_los_db : &facts.shadow_nlos_db);
      }
    }
  }
  facts.p_los = static_cast<double>(visible) / (sampled_cities * sampled_directions);
  facts.note =
      fmt::format("line of sight: share of {} links in {} cities with {:g} buildings per km2",
                  sampled_cities * sampled_directions, sampled_cities, world.number("building_density_per_km2"));
  return facts;
}

std::optional<radio::AerialScenario> scenario_of(const std::string& model) {
  for (const auto& choice : radio::aerial_scenarios)
    if (choice.word == model) return choice.meaning;
  return std::nullopt;
}

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  for (const radio::LinkModelType& type : radio::link_model_types()) names.push_back(type.name);
  return names;
}

int inspect_link(const LinkOptions& options) {
  const auto scenario = scenario_of(options.model);
  const LinkFacts facts =
      scenario ? of_standard(options, *scenario) : of_generated_worlds(options, radio::link_model_type(options.model));
  if (options.format == "json") {
    const nlohmann::ordered_json json{{"model", options.model},
                                      {"height_m", options.height_m},
                                      {"distance_m", options.distance_m},
                                      {"carrier_ghz", options.carrier_ghz},
                                      {"base_station_height_m", facts.base_station_height_m},
                                      {"p_los", facts.p_los},
                                      {"path_loss_los_db", facts.path_loss_los_db},
                                      {"path_loss_nlos_db", facts.path_loss_nlos_db},
                                      {"shadow_los_db", facts.shadow_los_db},
                                      {"shadow_nlos_db", facts.shadow_nlos_db},
                                      {"note", facts.note}};
    fmt::print("{}\n", json.dump(2));
    return exit_ok;
  }
  fmt::print("{}: UAV at {:g} m, {:g} m from a base station of {:g} m, {:g} GHz\n\n", options.model, options.height_m,
             options.distance_m, facts.base_station_height_m, options.carrier_ghz);
  fmt::print("                      line of sight    none\n");
  fmt::print("probability           {:13.4f}  {:6.4f}\n", facts.p_los, 1.0 - facts.p_los);
  fmt::print("path loss, dB         {:13.2f}  {:6.2f}\n", facts.path_loss_los_db, facts.path_loss_nlos_db);
  fmt::print("shadowing, +- dB      {:13.2f}  {:6.2f}\n\n{}\n", facts.shadow_los_db, facts.shadow_nlos_db, facts.note);
  return exit_ok;
}

}  // namespace

void add_inspect_link(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("link", "What a channel model says of one link: line of sight, loss, shadowing");
  auto options = std::make_shared<LinkOptions>();
  command->add_option("--model", options->model, "Channel model")->required()->check(CLI::IsMember(all_models()));
  command->add_option("--height", options->height_m, "Height of the UAV, m")
      ->required()
      ->check(runtime::number(0.0, 10'000.0));
  command->add_option("--distance", options->distance_m, "Distance on the ground to the base station, m")
      ->required()
      ->check(runtime::number(0.0, 100'000.0));
  command->add_option("--carrier", options->carrier_ghz, "Carrier frequency, GHz")
      ->check(runtime::number(0.1, 100.0))
      ->capture_default_str();
  add_format(*command, options->format, {"text", "json"});
  command->callback([options, &job] { job = [options] { return inspect_link(*options); }; });
}

}  // namespace aloft::cli
