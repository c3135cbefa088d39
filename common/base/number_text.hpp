#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace aloft {

/// The number that the whole text is; nullopt if it is something else, or beyond the range of `Number`.
template <typename Number>
[[nodiscard]] std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stopped == end ? std::optional(value) : std::nullopt;
}

}  // namespace aloft
