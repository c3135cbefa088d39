#pragma once

#include <string_view>

namespace aloft::agents {

/// data/models/pretrained.pb, carried inside the program.
[[nodiscard]] std::string_view builtin_model();
/// Of its bytes, as 64 hexadecimal digits.
[[nodiscard]] std::string_view builtin_model_sha256();

}  // namespace aloft::agents
