#pragma once

#include <span>
#include <string>
#include <string_view>

namespace aloft {

/// The candidate with the smallest edit distance to `word`, for "did you mean"; empty if none is close
/// (more than a third of the letters differ, and more than two).
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// " Did you mean 'x'?" or nothing.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace aloft
