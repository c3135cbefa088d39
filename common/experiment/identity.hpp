#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aloft::experiment {

/// 16 hexadecimal digits: hash of a canonical experiment without its description, file paths and names of worlds.
[[nodiscard]] std::string id_of(const nlohmann::json& canonical);

/// The first JSON path at which two canonical experiments differ in what makes their ids, and both values, e.g.
/// "worlds[1].los_ray: \"published\" against \"geometric\""; empty if they have the same id.
[[nodiscard]] std::string describe_difference(const nlohmann::json& a, const nlohmann::json& b);

}  // namespace aloft::experiment
