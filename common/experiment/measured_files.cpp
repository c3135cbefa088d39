#include "common/experiment/measured_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/read_file.hpp"
#include "common/radio/measured_map.hpp"
#include "common/world/measured_sites.hpp"

namespace aloft::experiment {
namespace {

std::string read_unchanged(NamedFile& file, std::string_view advice) {
  std::string csv = read_file(file.path);
  check_unchanged(file.path, csv, file.sha256, advice);
  file.sha256 = sha256_hex(csv);
  return csv;
}

/// The site map is flat, so the route must not be too long.
void check_route(const std::vector<world::Position>& route, const std::filesystem::path& flight_file) {
  for (std::size_t i = 0; i < route.size(); ++i) {
    const double distance_m = std::sqrt(route[i].x_m * route[i].x_m + route[i].y_m * route[i].y_m);
    if (distance_m > world::measured_map_radius_m)
      throw InputError(
          "{}: step {} is {:.0f} km from the middle of the route; with base stations at most {:.0f} km are possible: "
          "correct its latitude and longitude, or leave agents with the site map out",
          excerpt(flight_file.string()), i + 1, distance_m / 1e3, world::measured_map_radius_m / 1e3);
  }
}

/// Where the base stations of a measured flight can be.
std::array<std::filesystem::path, 2> places_of_sites(const std::filesystem::path& flight_file) {
  std::filesystem::path own = flight_file;
  own.replace_extension(".sites.csv");
  return {own, flight_file.parent_path() / "sites.csv"};
}

bool is_there(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored);
}

}  // namespace

world::LocatedFlight read_flight(NamedFile& file, std::string_view advice) {
  return world::parse_located_flight(read_unchanged(file, advice), file.path.string());
}

world::MeasuredSites read_sites(NamedFile& file, const world::LocatedFlight& flight,
                                const std::filesystem::path& flight_file, std::string_view advice) {
  if (flight.route.empty())
    throw InputError(
        "{}: this flight does not say where it was, so the base stations in {} are of no use: add the columns latitude "
        "and longitude, or leave out the base stations and agents with the site map",
        excerpt(flight_file.string()), excerpt(file.path.string()));
  world::MeasuredSites known =
      world::parse_measured_sites(read_unchanged(file, advice), file.path.string(), flight.route);
  check_route(known.route, flight_file);
  try {
    (void)radio::measured_survey(flight.flight, known);
  } catch (const InputError& error) {
    throw InputError(
        "{}: an agent with the site map cannot fly here, because generated worlds have no such heights: {}",
        excerpt(flight_file.string()), error.what());
  }
  return known;
}

bool has_sites(const std::filesystem::path& flight_file) {
  return std::ranges::any_of(places_of_sites(flight_file), is_there);
}

std::filesystem::path sites_beside(const std::filesystem::path& flight_file, std::string_view agent) {
  const auto [own, common] = places_of_sites(flight_file);
  for (const auto& file : {own, common})
    if (is_there(file)) return file;
  throw InputError(
      "{}: agent '{}' needs the base stations: {} or {} is missing; add it (columns cell, latitude, longitude, "
      "antenna_height_m, and optionally power_w, azimuth_deg), or leave '{}' out",
      excerpt(flight_file.string()), agent, excerpt(own.string()), excerpt(common.string()), agent);
}

}  // namespace aloft::experiment
