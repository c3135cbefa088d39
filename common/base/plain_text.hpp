#pragma once

#include <string>
#include <string_view>

namespace aloft {

/// Text from outside (the wire, a file, a command line) made safe to print on one line of a terminal or a log: line
/// breaks become "; ", and everything that is not printable is escaped, as \x1b or \u202e: control characters, escape
/// sequences, marks that change the direction of writing, bytes that are not UTF-8.
[[nodiscard]] std::string plain_text(std::string_view text);

/// The same for at most the first `longest` bytes; if the text is longer, its size is added.
[[nodiscard]] std::string plain_text(std::string_view text, std::size_t longest);

/// plain_text of the first 200 bytes, for messages that quote input.
[[nodiscard]] std::string excerpt(std::string_view text);

/// plain_text that keeps line breaks, for messages of several lines that quote input.
[[nodiscard]] std::string plain_lines(std::string_view text);

/// The first `longest` bytes of a text at most, cut so that no UTF-8 character is split.
[[nodiscard]] std::string_view beginning_of(std::string_view text, std::size_t longest) noexcept;

}  // namespace aloft
