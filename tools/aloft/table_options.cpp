#include "tools/aloft/table_options.hpp"

#include <unistd.h>

#include "common/base/terminal.hpp"

namespace aloft::cli {

void TableOptions::add_to(CLI::App& command, const std::string& what_is_brief) {
  auto* brief_flag = command.add_flag("--brief", brief, what_is_brief);
  command.add_flag("--wide", wide, "All columns side by side, also where they do not fit the terminal")
      ->excludes(brief_flag);
}

TableShape TableOptions::shape() const {
  return {
      .width = wide ? unlimited_width : text_width(STDOUT_FILENO), .brief = brief, .bold = isatty(STDOUT_FILENO) == 1};
}

}  // namespace aloft::cli
