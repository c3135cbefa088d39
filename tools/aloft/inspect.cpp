#include "common/radio/inspect.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/experiment/trial_world.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/find_condition.hpp"

namespace aloft::cli {
namespace {

struct InspectOptions {
  ExperimentOptions experiment;
  std::string condition = "0";
  std::uint32_t trial = 0;
  std::string explain;
  std::string format;
};

/// "STEP,HEIGHT" as given to --explain.
struct Place {
  std::uint32_t step = 0;
  double height_m = 0.0;
};

Place parse_place(const std::string& text) {
  Place place;
  std::size_t comma = 0;
  std::size_t end = 0;
  try {
    const long step = std::stol(text, &comma);
    if (step < 0 || comma >= text.size() || text[comma] != ',') throw std::invalid_argument(text);
    place.step = static_cast<std::uint32_t>(step);
    place.height_m = std::stod(text.substr(comma + 1), &end);
    if (comma + 1 + end != text.size() || !std::isfinite(place.height_m)) throw std::invalid_argument(text);
  } catch (const std::logic_error&) {
    throw InputError("--explain {}: not understood; use STEP,HEIGHT, e.g. 40,120", excerpt(text));
  }
  return place;
}

int explain(const InspectOptions& options, const experiment::Experiment& experiment,
            const experiment::Condition& condition) {
  const Place place = parse_place(options.explain);
  if (condition.kind == experiment::WorldKind::measured)
    throw InputError("--explain: a measured world has no radio model; every value is as it stands in the file");
  const auto map = experiment::make_signal_map(experiment, condition, options.trial);
  if (place.step > map->steps())
    throw InputError("--explain {}: there is no step {}; use 0 (the start) to {}", options.explain, place.step,
                     map->steps());
  const std::uint32_t point = place.step == 0 ? 0 : map->result_point(place.step);
  const radio::Explanation explanation =
      radio::explain(condition.world, experiment::make_city(experiment, condition, options.trial), experiment.seed,
                     options.trial, point, place.height_m);
  fmt::print("{}", options.format == "json" ? radio::to_json(explanation).dump(2) + "\n" : radio::to_text(explanation));
  return exit_ok;
}

int inspect_table(const InspectOptions& options) {
  const experiment::Experiment experiment = options.experiment.load();
  const experiment::Condition& condition = find_condition(experiment, options.condition);
  if (!options.explain.empty()) return explain(options, experiment, condition);
  const auto map = experiment::make_signal_map(experiment, condition, options.trial);
  options.format == "csv" ? radio::write_table_csv(std::cout, *map) : radio::write_table_json(std::cout, *map);
  return exit_ok;
}

int inspect_world(const InspectOptions& options) {
  const experiment::Experiment experiment = options.experiment.load();
  const experiment::Condition& condition = find_condition(experiment, options.condition);
  if (condition.kind == experiment::WorldKind::measured)
    throw InputError("condition {}: a measured world has no city; 'aloft inspect table' shows its grid",
                     condition.name);
  const world::City city = experiment::make_city(experiment, condition, options.trial);
  if (options.format == "csv")
    radio::write_world_csv(std::cout, condition.world, city);
  else
    fmt::print("{}\n", radio::world_to_json(condition.world, city).dump(2));
  return exit_ok;
}

std::shared_ptr<InspectOptions> add_options(CLI::App& command) {
  auto options = std::make_shared<InspectOptions>();
  options->experiment.add_to(command);
  command
      .add_option("--condition", options->condition, "Index or name of the condition, as 'aloft validate' lists them")
      ->capture_default_str();
  command.add_option("--trial", options->trial, "Trial, from 0")
      ->check(runtime::whole_number(0, 9'999'999))
      ->capture_default_str();
  add_format(command, options->format, {"json", "csv"});
  return options;
}

}  // namespace

void add_inspect(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("inspect", "Look into one trial, its world or its table of qualities, or at one radio link");
  command->require_subcommand(1);
  auto* world = command->add_subcommand("world", "Base stations, building heights and the route");
  auto world_options = add_options(*world);
  world->callback([world_options, &job] { job = [world_options] { return inspect_world(*world_options); }; });
  auto* table = command->add_subcommand("table", "Quality and serving cell over route point and height");
  auto table_options = add_options(*table);
  table->add_option("--explain", table_options->explain,
                    "STEP,HEIGHT: how that one value came about (as text, or --format json)");
  table->callback([table_options, table, &job] {
    // An explanation is for people unless a program asks for JSON.
    if (table->count("--format") == 0 && table->count("--explain") > 0) table_options->format = "text";
    job = [table_options] { return inspect_table(*table_options); };
  });
  add_inspect_link(*command, job);
}

}  // namespace aloft::cli
