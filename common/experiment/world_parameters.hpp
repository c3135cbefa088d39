#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/base/parameters.hpp"

namespace aloft::experiment {

/// Whether the files named in an experiment are read.
struct FileAccess {
  bool always_read = true;          ///< false: a file whose SHA-256 is already known is not touched
  std::string site_map_agent = {};  ///< an agent that needs the base stations of measured flights; empty: none does
};

/// Parameters of a world of kind "measured": the files, and their SHA-256 when the experiment was resolved.
[[nodiscard]] std::span<const ParameterSpec> measured_world_parameters();

/// A measured world with the paths made absolute and the SHA-256 filled in. Base stations that are not named are looked
/// for beside the flight if an agent needs them. Throws InputError if a file is missing, cannot be read, is ill-formed
/// (line, column, reason), or has changed since the SHA-256 was noted.
[[nodiscard]] Parameters resolve_measured_world(const nlohmann::json& given, std::string_view where,
                                                const FileAccess& files);

}  // namespace aloft::experiment
