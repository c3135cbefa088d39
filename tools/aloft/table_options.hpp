#pragma once

#include <CLI/App.hpp>
#include <string>

#include "common/base/text_layout.hpp"

namespace aloft::cli {

/// How text tables are fitted to standard output (base/terminal.hpp).
struct TableOptions {
  bool brief = false;  ///< only what matters most
  bool wide = false;   ///< everything side by side, however long the lines

  void add_to(CLI::App& command, const std::string& what_is_brief = "Only the columns that matter most");
  [[nodiscard]] TableShape shape() const;
};

}  // namespace aloft::cli
