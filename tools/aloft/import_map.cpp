#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/import_files.hpp"
#include "tools/importer/radio_map.hpp"

namespace aloft::cli {
namespace {

struct MapCommand {
  ImportFiles files;
  ImportRoute route;
  std::string origin = "0,0";
  std::optional<double> floor_dbm;
  importer::MapOptions world;
};

constexpr std::uint64_t largest_map_bytes = std::uint64_t{1} << 30U;

int import_map(MapCommand options) {
  const std::filesystem::path sites = options.files.beside(".sites.csv");
  options.files.check_target({options.files.beside(".import.json"), sites});
  options.world.route = options.route.corners();
  options.world.heights = options.route.heights;
  const world::Position origin = importer::parse_point("--origin", options.origin);
  options.world.origin = {origin.x_m, origin.y_m};
  if (!(std::abs(origin.x_m) <= 89.0 && std::abs(origin.y_m) <= 180.0))
    throw InputError("--origin {}: use a latitude from -89 to 89 and a longitude from -180 to 180 degrees",
                     options.origin);
  const std::string name = options.files.file.string();
  const std::string content = read_file(options.files.file, largest_map_bytes);
  const importer::RadioMap map(importer::NpzFile(content, name), options.floor_dbm);
  const importer::ImportedWorld world = importer::map_world(map, options.world, name);
  const std::string known_sites = importer::sites_csv(map, options.world.origin, name);
  const importer::RadioOptions& radio = options.world.radio;
  nlohmann::ordered_json facts{{"route", options.route.points},
                               {"origin", options.origin},
                               {"cells", map.cells().size()},
                               {"interpolation", "linear in x, y and z, in dB"},
                               {"bandwidth_mhz", radio.bandwidth_mhz},
                               {"noise_figure_db", radio.noise_figure_db},
                               {"spectral_efficiency_max", radio.spectral_efficiency_max},
                               {"steps", world.route.size()},
                               {"heights", world.height_m.size()}};
  if (options.floor_dbm) facts["floor_dbm"] = *options.floor_dbm;
  std::filesystem::remove(sites);  // of another map: --force was given
  if (!known_sites.empty()) write_file(sites, known_sites);
  options.files.write_facts(content, facts);
  write_file(options.files.out, importer::to_csv(world));
  fmt::print("{}: {}; {} cells{}\n", options.files.out.string(), size_of(world), map.cells().size(),
             known_sites.empty() ? "" : fmt::format(", their sites in {}", sites.string()));
  return exit_ok;
}

}  // namespace

void add_import_map(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("import-map", "Make a measured world (CSV) from a radio map of a ray tracer (NPZ)");
  auto options = std::make_shared<MapCommand>();
  options->files.add_to(*command, "The map: NPZ with power_dbm [cell, z, y, x] and the axes x, y, z in metres");
  options->route.add_to(*command, "Corners of the route, x and y in metres; a step every 10 m", true);
  command->add_option("--origin", options->origin, "Latitude and longitude of x = y = 0, degrees")
      ->type_name("A,B")
      ->capture_default_str();
  command->add_option("--floor", options->floor_dbm, "Power where a cell has none at all (-inf), dBm [refused]")
      ->check(runtime::number(-200, 0));
  add_radio_options(*command, options->world.radio);
  command->callback([options, &job] { job = [options] { return import_map(*options); }; });
}

}  // namespace aloft::cli
