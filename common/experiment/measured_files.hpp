#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/world/measured_flight.hpp"
#include "common/world/measured_world.hpp"

namespace aloft::experiment {

/// A file that a world names, and the SHA-256 that it must have; empty: any.
struct NamedFile {
  std::filesystem::path path;
  std::string sha256;
};

/// Reads a measured flight and notes the SHA-256 of its file. InputError if the file cannot be read, is ill-formed
/// (line, column, reason), or is another one; `advice` says what to do about that.
[[nodiscard]] world::LocatedFlight read_flight(NamedFile& file, std::string_view advice);

/// The same for its base stations. InputError also if the flight from `flight_file` does not say where it was, or is
/// one that an agent with the site map cannot fly.
[[nodiscard]] world::MeasuredSites read_sites(NamedFile& file, const world::LocatedFlight& flight,
                                              const std::filesystem::path& flight_file, std::string_view advice);

/// Whether there are base stations beside a measured flight.
[[nodiscard]] bool has_sites(const std::filesystem::path& flight_file);

/// The base stations beside a measured flight: NAME.sites.csv beside NAME.csv, or else sites.csv. InputError if neither
/// is there; it names the agent that needs them.
[[nodiscard]] std::filesystem::path sites_beside(const std::filesystem::path& flight_file, std::string_view agent);

}  // namespace aloft::experiment
