#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace aloft::experiment {

/// Reads JSON that people write, keeping the order of keys. Throws InputError "WHERE: line L, column C: why" if it is
/// malformed or an object has a key twice.
[[nodiscard]] nlohmann::ordered_json parse_json(std::string_view text, std::string_view where);

}  // namespace aloft::experiment
