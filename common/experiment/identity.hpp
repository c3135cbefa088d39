#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aloft::experiment {

/// 16 hexadecimal digits: hash of a canonical experiment without its description, file paths and names of worlds.
[[nodiscard]] std::string id_of(const nlohmann::json& canonical);

/// The part of a canonical experiment that can change a result, every default included: all but its description, names
/// of worlds and paths of files, which count by their SHA-256.
[[nodiscard]] nlohmann::json what_counts(const nlohmann::json& canonical);

/// The differences because of which two experiments have different ids, in words: the first three with both values,
/// e.g. "trials is 20 there and 100 here"; empty if they have the same id.
[[nodiscard]] std::string describe_differences(const nlohmann::json& there, const nlohmann::json& here);

}  // namespace aloft::experiment
