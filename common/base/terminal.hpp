#pragma once

#include <cstddef>

namespace aloft {

/// The width that text for people has on standard output or standard error: COLUMNS if it is set to a number, else what
/// the terminal says (80 if it does not), else, for a file or a pipe, unlimited_width.
[[nodiscard]] std::size_t text_width(int descriptor);

/// The columns of the terminal itself, whatever COLUMNS says; none: it is no terminal, or does not say.
[[nodiscard]] std::size_t terminal_columns(int descriptor);

}  // namespace aloft
