#include "common/base/plain_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace aloft {
namespace {

bool needs_no_care(char c) noexcept {
  return c >= ' ' && c <= '~';
}

/// Escapes what is not printable by fmt's debug form, which would also escape quotes and backslashes: these are copied
/// as they are.
void append_debug_form(std::string& plain, std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\"\\"), text.size());
    const std::string quoted = fmt::format("{:?}", text.substr(0, end));
    plain.append(quoted, 1, quoted.size() - 2);
    if (end < text.size()) plain += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::string on_lines(std::string_view text, std::string_view line_break) {
  if (std::ranges::all_of(text, needs_no_care)) return std::string(text);
  std::string plain;
  while (true) {
    const std::size_t end = text.find('\n');
    append_debug_form(plain, text.substr(0, end));
    if (end == std::string_view::npos) return plain;
    text.remove_prefix(end + 1);
    plain += line_break;
  }
}

}  // namespace

std::string plain_text(std::string_view text) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  return on_lines(text, "; ");
}

std::string plain_text(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return plain_text(text);
  return fmt::format("{}... ({} bytes)", plain_text(beginning_of(text, longest)), text.size());
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t longest = 200;
  return plain_text(text, longest);
}

std::string plain_lines(std::string_view text) {
  return on_lines(text, "\n");
}

std::string_view beginning_of(std::string_view text, std::size_t longest) noexcept {
  if (text.size() <= longest) return text;
  const auto within_character = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U; };
  std::size_t end = longest;
  while (end > 0 && longest - end < 3 && within_character(end)) --end;
  return text.substr(0, within_character(end) ? longest : end);
}

}  // namespace aloft
