#pragma once

#include <CLI/App.hpp>
#include <CLI/FormatterFwd.hpp>
#include <string>
#include <string_view>

namespace aloft::runtime {

/// Help that fits the terminal: usage, options with their ranges and defaults in words, commands by group, and the
/// footer as it is.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

/// Returns `exit_code`, or reports and returns exit_failure if standard output could not be written completely.
[[nodiscard]] int with_output_written(int exit_code, std::string_view program);

}  // namespace aloft::runtime
