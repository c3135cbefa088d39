#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/import_files.hpp"
#include "tools/importer/scatter_world.hpp"

namespace aloft::cli {
namespace {

using importer::Quantity;

struct QuantityOption {
  const char* flag;
  Quantity quantity;
  const char* name;
  const char* about;
};

constexpr QuantityOption quantity_options[] = {
    {"--rsrp", Quantity::rsrp_dbm, "rsrp_dbm", "Column of the RSRP, dBm; one row per cell that was heard"},
    {"--rsrq", Quantity::rsrq_db, "rsrq_db", "Column of the RSRQ of the serving cell, dB"},
    {"--sinr", Quantity::sinr_db, "sinr_db", "Column of the SINR of the serving cell, dB"},
    {"--throughput", Quantity::throughput_kbps, "throughput_kbps", "Column of the throughput"},
};

struct ScatterCommand {
  ImportFiles files;
  ImportRoute route;
  importer::ScatterColumns columns;
  importer::ScatterOptions world;
  std::string throughput_unit = "kbit/s";
};

double kbps_per(const std::string& unit) {
  if (unit == "bit/s") return 1e-3;
  return unit == "Mbit/s" ? 1e3 : 1.0;
}

const char* name_of(Quantity quantity) {
  return std::ranges::find(quantity_options, quantity, &QuantityOption::quantity)->name;
}

/// To a thousandth: more means nothing.
double rounded(double error) {
  return std::round(error * 1e3) / 1e3;
}

nlohmann::ordered_json to_json(const importer::HeldOutError& error) {
  nlohmann::ordered_json json{{"samples", error.samples}, {"predicted", error.predicted}};
  if (error.predicted > 0) {
    json["mean_error"] = rounded(error.mean);
    json["rms_error"] = rounded(error.root_mean_square);
  }
  return json;
}

nlohmann::ordered_json facts_of(const ScatterCommand& options, const importer::Scatter& scatter,
                                const importer::ImportedWorld& world, const importer::HeldOut& held_out) {
  nlohmann::ordered_json held{{"unit", importer::unit_of(scatter.quantity)}};
  if (scatter.has_times) held["apart_s"] = options.world.apart_s;
  held.update(to_json(held_out.all));
  if (scatter.has_cells) {
    held["cells"] = nlohmann::ordered_json::array();
    for (const importer::HeldOutError& error : held_out.by_cell) {
      nlohmann::ordered_json of_cell{{"cell", error.cell}};
      of_cell.update(to_json(error));
      held["cells"].push_back(of_cell);
    }
  }
  return {{"quantity", name_of(scatter.quantity)},
          {"samples", scatter.samples.size()},
          {"interpolation", "per cell, mean weighted by 1 / max(distance, 1 m)^2"},
          {"radius_m", options.world.reach.radius_m},
          {"height_radius_m", options.world.reach.height_radius_m},
          {"hole_max_m", options.world.hole_max_m},
          {"ground_m", options.columns.ground_m},
          {"bandwidth_mhz", options.world.radio.bandwidth_mhz},
          {"noise_figure_db", options.world.radio.noise_figure_db},
          {"spectral_efficiency_max", options.world.radio.spectral_efficiency_max},
          {"serving_load", options.world.radio.serving_load},
          {"steps", world.route.size()},
          {"heights", world.height_m.size()},
          {"observed", std::ranges::count(world.values, true, &importer::ImportedValue::observed)},
          {"held_out", held}};
}

void print_error(const std::string& what, const importer::HeldOutError& error, const char* unit) {
  fmt::print("{}: {} of {} samples predicted", what, error.predicted, error.samples);
  if (error.predicted > 0)
    fmt::print(", rms error {:g} {}, mean error {:+g} {}", rounded(error.root_mean_square), unit, rounded(error.mean),
               unit);
  fmt::print("\n");
}

void print_outcome(const ScatterCommand& options, const importer::Scatter& scatter,
                   const importer::ImportedWorld& world, const importer::HeldOut& held_out) {
  fmt::print(
      "{}: {}; {} of {} values have samples within {:g} m and {:g} m of height ({} samples), the others are those of "
      "the nearest step, marked observed = 0\n",
      options.files.out.string(), size_of(world),
      std::ranges::count(world.values, true, &importer::ImportedValue::observed), world.values.size(),
      options.world.reach.radius_m, options.world.reach.height_radius_m, scatter.samples.size());
  const char* const unit = importer::unit_of(scatter.quantity);
  print_error(scatter.has_times ? fmt::format("held out, at least {:g} s apart", options.world.apart_s) : "held out",
              held_out.all, unit);
  constexpr std::size_t shown = 10;
  if (!scatter.has_cells) return;
  for (std::size_t i = 0; i < std::min(shown, held_out.by_cell.size()); ++i)
    print_error(fmt::format("  cell {}", held_out.by_cell[i].cell), held_out.by_cell[i], unit);
  if (held_out.by_cell.size() > shown)
    fmt::print("  and {} more in {}\n", held_out.by_cell.size() - shown, options.files.beside(".import.json").string());
}

int import_scatter(ScatterCommand options) {
  options.files.check_target({options.files.beside(".import.json")});
  options.world.route = options.route.corners();
  options.world.heights = options.route.heights;
  if (options.columns.quantity == Quantity::throughput_kbps)
    options.columns.kbps_per_unit = kbps_per(options.throughput_unit);
  const std::string name = options.files.file.string();
  const std::string content = read_file(options.files.file);
  const importer::Scatter scatter = importer::parse_scatter(content, name, options.columns);
  const importer::ImportedWorld world = importer::scatter_world(scatter, options.world, name);
  const importer::HeldOut held_out = importer::held_out_error(scatter, options.world);
  options.files.write_facts(content, facts_of(options, scatter, world, held_out));
  write_file(options.files.out, importer::to_csv(world));
  print_outcome(options, scatter, world, held_out);
  return exit_ok;
}

void add_columns(CLI::App& command, ScatterCommand& options) {
  command.add_option("--latitude", options.columns.latitude, "Column of the latitude, degrees")
      ->type_name("COLUMN")
      ->capture_default_str();
  command.add_option("--longitude", options.columns.longitude, "Column of the longitude, degrees")
      ->type_name("COLUMN")
      ->capture_default_str();
  command.add_option("--altitude", options.columns.altitude, "Column of the altitude, m")
      ->type_name("COLUMN")
      ->capture_default_str();
  auto* value = command.add_option_group("What was measured");
  for (const QuantityOption& one : quantity_options)
    value
        ->add_option_function<std::string>(
            one.flag,
            [&options, quantity = one.quantity](const std::string& column) {
              options.columns.value = column;
              options.columns.quantity = quantity;
            },
            one.about)
        ->type_name("COLUMN");
  value->require_option(1);
  command.add_option("--throughput-unit", options.throughput_unit, "Unit of the throughput")
      ->check(CLI::IsMember({"bit/s", "kbit/s", "Mbit/s"}))
      ->capture_default_str();
  command.add_option("--cell", options.columns.cell, "Column of the cell's number")->type_name("COLUMN");
  command
      .add_option("--time", options.columns.time,
                  "Column of the time: seconds, or a date and time such as 2026-05-01T12:00:00Z")
      ->type_name("COLUMN");
  command.add_option("--ground", options.columns.ground_m, "Altitude of the ground, from which heights count, m")
      ->check(runtime::number(-1'000, 10'000))
      ->capture_default_str();
}

}  // namespace

void add_import_scatter(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("import-scatter", "Make a measured world (CSV) from measurements that lie anywhere (CSV)");
  auto options = std::make_shared<ScatterCommand>();
  options->files.add_to(*command, "The measurements: CSV with a header, one row per sample");
  add_columns(*command, *options);
  options->route.add_to(
      *command, "Corners of the route, latitude and longitude; a step every 10 m [where the lowest samples are]",
      false);
  command->add_option("--radius", options->world.reach.radius_m, "How far a sample counts over the ground, m")
      ->check(runtime::number(0.1, 10'000))
      ->capture_default_str();
  command->add_option("--height-radius", options->world.reach.height_radius_m, "How far it counts up and down, m")
      ->check(runtime::number(0.1, 10'000))
      ->capture_default_str();
  command
      ->add_option("--hole-max", options->world.hole_max_m,
                   "How far along the route a value may come from where there are no samples, m")
      ->check(runtime::number(0, 1e6))
      ->capture_default_str();
  command
      ->add_option("--apart", options->world.apart_s,
                   "For the error: a sample is predicted from others at least this long before or after it, s")
      ->check(runtime::number(0, 1e6))
      ->capture_default_str();
  add_radio_options(*command, options->world.radio);
  command
      ->add_option("--serving-load", options->world.radio.serving_load,
                   "For RSRQ: share of the serving cell's resource elements in use while it was measured")
      ->check(runtime::number(1.0 / 6.0, 1.0))
      ->capture_default_str();
  command->callback([options, &job] { job = [options] { return import_scatter(*options); }; });
}

}  // namespace aloft::cli
