#pragma once

#include <CLI/App.hpp>
#include <CLI/FormatterFwd.hpp>
#include <string>

namespace aloft::runtime {

/// Help that fits the terminal: usage, options with their ranges and defaults in words, commands by group, and the
/// footer as it is.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace aloft::runtime
