#include "tools/aloft/table_options.hpp"

#include <unistd.h>

#include "common/base/terminal.hpp"
#include "tools/aloft/commands.hpp"

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

void add_format(CLI::App& command, std::string& format, std::vector<std::string> choices) {
  format = choices.front();
  command.add_option("--format", format, "Output format")
      ->check(CLI::IsMember(std::move(choices)))
      ->capture_default_str();
}

}  // namespace aloft::cli
