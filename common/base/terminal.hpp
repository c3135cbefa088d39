#pragma once

#include <cstddef>

namespace aloft {

/// The width of text for people on standard output or standard error: COLUMNS if it is set to a number, else the width
/// that the terminal reports (80 if it reports none), else, for a file or a pipe, unlimited_width.
[[nodiscard]] std::size_t text_width(int descriptor);

/// The width that the terminal reports, whatever COLUMNS says; 0 if it is no terminal or reports none.
[[nodiscard]] std::size_t terminal_columns(int descriptor);

}  // namespace aloft
