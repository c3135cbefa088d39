#include "common/experiment/world_parameters.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/experiment/file_paths.hpp"
#include "common/experiment/measured_files.hpp"

namespace aloft::experiment {
namespace {

/// Experiments from before the parameter existed keep their ids.
ParameterSpec implied(ParameterSpec spec) {
  spec.default_is_implied = true;
  return spec;
}

NamedFile named_file(const Parameters& world, const std::string& key) {
  const std::string& path = world.text(key);
  return {path.empty() ? "" : std::filesystem::absolute(path).lexically_normal(), world.text(key + "_sha256")};
}

/// What `read` returns; its errors begin with the JSON path.
template <typename Read>
auto named(std::string_view where, std::string_view key, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError("{}.{}: {}", where, key, error.what());
  }
}

}  // namespace

std::span<const ParameterSpec> measured_world_parameters() {
  static const std::vector<ParameterSpec> table{
      text_parameter(
          "file", "",
          "Path of the CSV file with the measured flight; a relative one counts from the experiment file's folder."),
      text_parameter("file_sha256", "", "SHA-256 that the file must have; filled in when an experiment is resolved."),
      implied(text_parameter("sites_file", "",
                             "Path of the CSV file with the base stations, for agents with the site map; if it is not "
                             "given, NAME.sites.csv or sites.csv beside the flight NAME.csv.")),
      implied(text_parameter("sites_file_sha256", "",
                             "SHA-256 that sites_file must have; filled in when an experiment is resolved.")),
  };
  return table;
}

Parameters resolve_measured_world(const nlohmann::json& given, std::string_view where, const FileAccess& files) {
  const Parameters checked(measured_world_parameters(), given, where);
  if (checked.text("file").empty())
    throw InputError("{}.file: missing; give the path of a CSV file with the measured flight", where);
  NamedFile flight = named_file(checked, "file");
  NamedFile sites = named_file(checked, "sites_file");
  const bool with_sites = !sites.path.empty() || !files.site_map_agent.empty();
  if (files.always_read || flight.sha256.empty() || (with_sites && sites.sha256.empty())) {
    const world::LocatedFlight located = named(where, "file", [&] {
      flight.path = locate(flight.path);
      if (with_sites && sites.path.empty()) sites.path = sites_beside(flight.path, files.site_map_agent);
      return read_flight(flight, "use the original file, or remove file_sha256 to take this one");
    });
    if (with_sites)
      named(where, "sites_file", [&] {
        sites.path = locate(sites.path);
        return read_sites(sites, located, flight.path,
                          "use the original file, or remove sites_file_sha256 to take this one");
      });
  }
  nlohmann::json resolved{{"file", flight.path.string()}, {"file_sha256", flight.sha256}};
  if (with_sites) resolved.update({{"sites_file", sites.path.string()}, {"sites_file_sha256", sites.sha256}});
  return Parameters(measured_world_parameters(), resolved, where);
}

}  // namespace aloft::experiment
