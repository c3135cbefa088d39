#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/parameters.hpp"

namespace aloft::radio {

struct LinkModelType;

/// All parameters of a generated world, with the defaults of preset `published`: city, route, heights, the choice of
/// the channel model, the parameters of every channel model, radio, the choice of the serving cell with the parameters
/// of handover.
[[nodiscard]] const std::vector<ParameterSpec>& generated_world_parameters();
/// The parameters of a generated world with this channel model; `handover`: with serving "a3".
[[nodiscard]] std::vector<ParameterSpec> generated_world_parameters(const LinkModelType& model, bool handover = false);

/// The presets whose worlds have this channel model, unless they name another one.
[[nodiscard]] std::vector<std::string> presets_with(const LinkModelType& model);

/// A generated world's parameters from a JSON object of overrides: `preset` changes the defaults, every other key
/// overrides them. Parameters of channel models other than `propagation` are unknown keys. Resolving the result's
/// to_json() again gives the same. Throws InputError naming `where` for unknown keys, values out of range, and
/// combinations that contradict each other.
[[nodiscard]] Parameters resolve_generated_world(const nlohmann::json& given, std::string_view where);

}  // namespace aloft::radio
