#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace aloft {

/// Parses JSON and keeps the order of keys. -0.0 is read as the 0.0 that it equals: written out it would look like
/// another value, and two names or identifiers would stand for one thing. All JSON from outside is read by this
/// function. Throws InputError "WHERE: line L, column C: why" if it is malformed, if an object has a key twice, or if
/// it exceeds limits::json_bytes or limits::json_depth: the library recurses once per level, without a limit of its
/// own.
[[nodiscard]] nlohmann::ordered_json parse_json(std::string_view text, std::string_view where);

}  // namespace aloft
