#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace aloft {

/// Reads JSON from outside, keeping the order of keys: the one way in for all of it. Throws InputError "WHERE: line L,
/// column C: why" if it is malformed, an object has a key twice, or it is larger or nested deeper than
/// limits::json_bytes and json_depth: the library's functions call themselves once per level, down to any depth.
[[nodiscard]] nlohmann::ordered_json parse_json(std::string_view text, std::string_view where);

}  // namespace aloft
