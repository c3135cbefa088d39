#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "common/base/parameters.hpp"

namespace aloft::radio {

struct LinkModelType;

/// Everything adjustable in a generated world, with the defaults of preset `published`: city, route, heights, the
/// channel model and the parameters of each, radio.
[[nodiscard]] const std::vector<ParameterSpec>& generated_world_parameters();
/// The same with one channel model: all that such a world has.
[[nodiscard]] std::vector<ParameterSpec> generated_world_parameters(const LinkModelType& model);

/// A generated world's parameters from a JSON object of overrides: `preset` changes the defaults, every other key
/// overrides them. A parameter of another channel model than `propagation` is unknown there. Resolving the result's
/// to_json() again gives the same. Throws InputError naming `where` for unknown keys, values out of range, and
/// combinations that contradict each other.
[[nodiscard]] Parameters resolve_generated_world(const nlohmann::json& given, std::string_view where);

}  // namespace aloft::radio
