#pragma once

#include <string>
#include <string_view>

namespace aloft {

/// Text from outside (the wire, a file, a command line) as it may stand on a line of a terminal or of a log: line
/// breaks become "; ", and whatever is not printable is written out, as \x1b or \u202e: control characters, escape
/// sequences, marks that turn the direction of writing, bytes that are not UTF-8.
[[nodiscard]] std::string plain_text(std::string_view text);

/// The same of at most the first `longest` bytes; if that is not all, the size of the whole is added.
[[nodiscard]] std::string plain_text(std::string_view text, std::size_t longest);

/// Input that a message repeats: plain_text of its first 200 bytes.
[[nodiscard]] std::string excerpt(std::string_view text);

/// The same for a text of several lines, which stay lines: for messages of our own that quote others.
[[nodiscard]] std::string plain_lines(std::string_view text);

/// The beginning of a text, of at most `longest` bytes, that does not end within a character of UTF-8.
[[nodiscard]] std::string_view beginning_of(std::string_view text, std::size_t longest) noexcept;

}  // namespace aloft
