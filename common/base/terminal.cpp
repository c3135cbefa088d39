#include "common/base/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include "common/base/number_text.hpp"
#include "common/base/text_layout.hpp"

namespace aloft {
namespace {

constexpr std::size_t usual_columns = 80;

/// COLUMNS; 0 if it is not set or not a number.
std::size_t columns_asked_for() {
  const char* text = std::getenv("COLUMNS");
  return text == nullptr ? 0 : number_in<std::size_t>(text).value_or(0);
}

}  // namespace

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::size_t text_width(int descriptor) {
  if (const std::size_t asked = columns_asked_for(); asked > 0) return asked;
  if (isatty(descriptor) != 1) return unlimited_width;
  const std::size_t columns = terminal_columns(descriptor);
  return columns > 0 ? columns : usual_columns;
}

}  // namespace aloft
