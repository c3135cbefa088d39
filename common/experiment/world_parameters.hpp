#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>

#include "common/base/parameters.hpp"

namespace aloft::experiment {

/// Whether the files named in an experiment are read.
struct FileAccess {
  bool always_read = true;  ///< false: a file whose SHA-256 is already known is not touched
};

/// Parameters of a world of kind "measured": the file, and its SHA-256 when the experiment was resolved.
[[nodiscard]] std::span<const ParameterSpec> measured_world_parameters();

/// A measured world with the path made absolute and the SHA-256 filled in. Throws InputError if the file cannot be
/// read, is ill-formed (line, column, reason), or has changed since the SHA-256 was noted.
[[nodiscard]] Parameters resolve_measured_world(const nlohmann::json& given, std::string_view where,
                                                const FileAccess& files);

}  // namespace aloft::experiment
