#pragma once

#include <string_view>

namespace aloft::agents {

/// The bytes of data/models/pretrained.pb, linked into the program.
[[nodiscard]] std::string_view builtin_model();
/// The SHA-256 of these bytes, as 64 hexadecimal digits.
[[nodiscard]] std::string_view builtin_model_sha256();

}  // namespace aloft::agents
