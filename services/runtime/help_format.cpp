#include "services/runtime/help_format.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iostream>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"

namespace aloft::runtime {
namespace {

constexpr std::size_t widest_help = 100;  // longer lines are hard to read
constexpr std::size_t names_column = 28;

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// An option's placeholder, and the values that it allows, in words.
struct Value {
  std::string placeholder;
  std::string allowed;
};

/// CLI11 gives "TYPE:CHECK", where the check can be "{a,b}" or a placeholder.
Value value_of(const CLI::Option& option) {
  if (option.get_type_size() == 0) return {};
  const std::string full = option.get_type_name();
  const std::size_t colon = std::min(full.find(':'), full.size());
  Value value{full.substr(0, colon), full.substr(std::min(colon + 1, full.size()))};
  if (value.placeholder == "UINT" || value.placeholder == "INT") value.placeholder = "N";
  if (value.placeholder == "FLOAT") value.placeholder = "X";
  if (value.allowed.starts_with('{') && value.allowed.ends_with('}')) {
    std::string choices;
    for (const char c : value.allowed.substr(1, value.allowed.size() - 2))
      choices += c == ',' ? std::string(" or ") : std::string(1, c);
    value.allowed = choices;
  } else if (!value.allowed.empty() && value.allowed == upper_case(value.allowed) && std::isalpha(value.allowed[0])) {
    value.placeholder = std::exchange(value.allowed, "");
  }
  return value;
}

/// CLI11 gives lists as [a,b], and paths in quotes.
std::string default_of(const CLI::Option& option) {
  std::string text = option.get_default_str();
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('"', '"')})
    if (text.size() >= 2 && text.front() == open && text.back() == close) text = text.substr(1, text.size() - 2);
  return text;
}

std::string names_of(const CLI::Option& option) {
  if (option.get_positional()) return upper_case(option.get_name(true, false));
  const std::string placeholder = value_of(option).placeholder;
  return option.get_name(false, true) + (placeholder.empty() ? "" : " " + placeholder);
}

std::string description_of(const CLI::Option& option) {
  std::string text = option.get_description();
  if (const std::string allowed = value_of(option).allowed; !allowed.empty()) text += fmt::format(" ({})", allowed);
  if (const std::string value = default_of(option); !value.empty()) text += fmt::format(" [{}]", value);
  return text;
}

/// A name with its explanation beside it, or below it if the name is long.
std::string entry(const std::string& name, const std::string& explanation, std::size_t width) {
  const std::string indent(names_column, ' ');
  std::string first = "  " + name;
  std::string above;
  if (first.size() + 2 > names_column) std::swap(above, first);
  first.resize(names_column, ' ');
  return (above.empty() ? "" : above + '\n') + wrapped(explanation, width, first, indent);
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([&](const CLI::Option* option) {
    return !option->get_group().empty() && option->get_positional() == positional;
  });
}

std::string usage(const CLI::App& app, const std::string& name) {
  std::string text = fmt::format("Usage: {}", name);
  for (const CLI::Option* option : options_of(app, false))
    if (option->get_required()) text += " " + names_of(*option);
  text += " [OPTIONS]";
  for (const CLI::Option* option : options_of(app, true)) {
    const bool several = option->get_expected_max() >= CLI::detail::expected_max_vector_size;
    const std::string names = names_of(*option) + (several ? "..." : "");
    text += option->get_required() ? " " + names : fmt::format(" [{}]", names);
  }
  const bool commands =
      !app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); }).empty();
  return text + (commands ? " COMMAND" : "");
}

std::string options_text(const CLI::App& app, bool positional, const std::string& heading, std::size_t width) {
  std::string text;
  for (const CLI::Option* option : options_of(app, positional))
    text += entry(names_of(*option), description_of(*option), width);
  return text.empty() ? text : fmt::format("\n{}{}", heading.empty() ? "" : heading + ":\n", text);
}

/// Subcommands without a name are groups of options of the command itself.
std::string commands_text(const CLI::App& app, std::size_t width) {
  std::vector<std::pair<std::string, std::string>> groups;
  std::string choices;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name().empty()) {
      choices += options_text(*command, false,
                              command->get_require_option_min() == 1 ? "One of these is needed" : "Options", width);
      continue;
    }
    auto group = std::ranges::find_if(groups, [&](const auto& other) { return other.first == command->get_group(); });
    if (group == groups.end()) group = groups.insert(groups.end(), {command->get_group(), ""});
    group->second += entry(command->get_name(), command->get_description(), width);
  }
  for (const auto& [name, entries] : groups)
    choices += fmt::format("\n{}:\n{}", name == "Subcommands" ? "Commands" : name, entries);
  return choices;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode /*mode*/) const {
  const std::size_t width = std::min(text_width(STDOUT_FILENO), widest_help);
  std::string description = app->get_description();
  if (!description.ends_with('.')) description += '.';
  std::string text = wrapped(description, width) + '\n';
  text += wrapped(usage(*app, name), width, "", "  ");
  text += options_text(*app, true, "", width);
  text += commands_text(*app, width);
  text += options_text(*app, false, "Options", width);
  if (!app->get_footer().empty()) text += '\n' + app->get_footer() + '\n';
  return text;
}

int with_output_written(int exit_code, std::string_view program) {
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good();
  if (written) return exit_code;
  fmt::print(stderr, "{}: cannot write to standard output; is the disk full that it goes to?\n", program);
  return exit_code == exit_ok ? exit_failure : exit_code;
}

}  // namespace aloft::runtime
