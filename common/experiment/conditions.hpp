#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/experiment/world_parameters.hpp"

namespace aloft::experiment {

inline constexpr std::size_t max_conditions = 10'000;
inline constexpr std::size_t max_world_name_bytes = 200;

/// The conditions of "world", or of all "worlds", in the order of the sweeps: every value that is a list is swept, the
/// first key of the file changes slowest. Throws InputError naming the JSON path.
[[nodiscard]] std::vector<Condition> expand_worlds(const nlohmann::ordered_json& document, const FileAccess& files);

/// The entry of "worlds" from which expand_worlds() makes this condition again.
[[nodiscard]] nlohmann::json canonical_world(const Condition& condition);

}  // namespace aloft::experiment
