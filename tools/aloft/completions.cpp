// What a shell needs to complete the words of a command line, made from the same options as the help.
#include "tools/aloft/completions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "common/base/error.hpp"
#include "tools/aloft/package_data.hpp"

namespace aloft::cli {
namespace {

struct OptionWord {
  std::string name;  ///< "--format"
  std::string about;
  bool takes_value = false;
  std::vector<std::string> choices;  ///< empty: any value, often a file
};

/// A command, its options, and what may follow it without an option.
struct CommandWords {
  std::string path;   ///< "aloft keys init"
  std::string about;  ///< one line
  std::vector<OptionWord> options;
  std::vector<std::string> values;  ///< for its arguments; empty: files
  std::vector<std::string> commands;
};

/// CLI11 describes a choice as "TEXT:{text,json}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find(":{");
  if (open == std::string::npos || !type.ends_with('}')) return {};
  return CLI::detail::split(type.substr(open + 2, type.size() - open - 3), ',');
}

void add_options(CommandWords& words, const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    if (option->get_positional()) words.values = choices_of(*option);
    if (option->get_name() == "experiment") words.values = package_experiments();
    for (const std::string& name : option->get_lnames())
      if (name != "help" || words.options.empty())  // a group of options has a --help of its own
        words.options.push_back(
            {"--" + name, option->get_description(), option->get_items_expected_max() > 0, choices_of(*option)});
  }
}

void add_words(std::vector<CommandWords>& all, const CLI::App& command, const std::string& path) {
  CommandWords words{path, command.get_description(), {}, {}, {}};
  add_options(words, command);
  const std::vector<const CLI::App*> below = command.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* part : below) {
    if (part->get_name().empty())  // a group of options
      add_options(words, *part);
    else
      words.commands.push_back(part->get_name());
  }
  all.push_back(std::move(words));
  for (const CLI::App* part : below)
    if (!part->get_name().empty()) add_words(all, *part, path + " " + part->get_name());
}

std::vector<std::string> names_of(const std::vector<OptionWord>& options) {
  std::vector<std::string> names;
  names.reserve(options.size());
  for (const OptionWord& option : options) names.push_back(option.name);
  return names;
}

/// What the command with this path is for.
const std::string& about(const std::vector<CommandWords>& all, const std::string& path) {
  return std::find_if(all.begin(), all.end(), [&](const CommandWords& one) { return one.path == path; })->about;
}

/// A text between single quotes, for all three shells.
std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

/// Patterns of a shell's case statement that match an option after its command, by the choices that the option has.
std::map<std::string, std::string> value_cases(const std::vector<CommandWords>& all) {
  std::map<std::string, std::string> patterns;
  for (const CommandWords& command : all)
    for (const OptionWord& option : command.options) {
      if (!option.takes_value) continue;
      std::string& pattern = patterns[fmt::format("{}", fmt::join(option.choices, " "))];
      pattern += (pattern.empty() ? "" : "|") + shell_quoted(command.path + " " + option.name);
    }
  return patterns;
}

/// The body of the loop that finds the command which the words before the cursor name.
std::string path_case(const std::vector<CommandWords>& all, const char* word) {
  std::vector<std::string> paths;
  paths.reserve(all.size());
  for (const CommandWords& command : all) paths.push_back(shell_quoted(command.path));
  return fmt::format("    case \"$place {0}\" in {1}) place+=\" {0}\" ;; esac\n", word, fmt::join(paths, "|"));
}

std::string for_bash(const std::vector<CommandWords>& all) {
  std::string text =
      "# Completes the words of aloft in bash; made by: aloft completions bash\n"
      "_aloft() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} place=aloft words='' i\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n" +
      path_case(all, "${COMP_WORDS[i]}") +
      "  done\n"
      "  case \"$place ${COMP_WORDS[COMP_CWORD - 1]}\" in\n";
  for (const auto& [choices, pattern] : value_cases(all))
    text += fmt::format("    {}) COMPREPLY=($(compgen -W '{}' -- \"$word\")); return ;;\n", pattern, choices);
  text += "  esac\n  case \"$place\" in\n";
  for (const CommandWords& command : all)
    text += fmt::format("    '{}') words='{} {} {}' ;;\n", command.path, fmt::join(command.commands, " "),
                        fmt::join(names_of(command.options), " "), fmt::join(command.values, " "));
  return text +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "}\n"
         "complete -o default -F _aloft aloft\n";
}

/// "name:about", in which zsh's _describe wants ':' of the name escaped; ours have none.
std::string described(const std::string& name, const std::string& about) {
  return " " + shell_quoted(name + ":" + about);
}

std::string for_zsh(const std::vector<CommandWords>& all) {
  std::string text =
      "#compdef aloft\n"
      "# Completes the words of aloft in zsh; made by: aloft completions zsh\n"
      "_aloft() {\n"
      "  local place=aloft word\n"
      "  local -a found\n"
      "  for word in \"${(@)words[2,CURRENT-1]}\"; do\n" +
      path_case(all, "$word") +
      "  done\n"
      "  case \"$place $words[CURRENT-1]\" in\n";
  for (const auto& [choices, pattern] : value_cases(all))
    text += choices.empty() ? fmt::format("    {}) _files; return ;;\n", pattern)
                            : fmt::format("    {}) found=({}); _describe value found; return ;;\n", pattern, choices);
  text += "  esac\n  case \"$place\" in\n";
  for (const CommandWords& command : all) {
    text += fmt::format("    '{}') found=(", command.path);
    for (const std::string& name : command.commands) text += described(name, about(all, command.path + " " + name));
    for (const std::string& value : command.values) text += " " + shell_quoted(value);
    for (const OptionWord& option : command.options) text += described(option.name, option.about);
    text += ") ;;\n";
  }
  return text +
         "  esac\n"
         "  _describe aloft found\n"
         "  _files\n"
         "}\n"
         "_aloft \"$@\"\n";
}

/// The condition under which fish offers what follows a command: its words have been typed, and none of a command
/// below.
std::string fish_condition(const CommandWords& command) {
  if (command.path == "aloft") return "__fish_use_subcommand";
  std::string condition;
  for (const std::string& word : CLI::detail::split(command.path.substr(command.path.find(' ') + 1), ' '))
    condition += fmt::format("{}__fish_seen_subcommand_from {}", condition.empty() ? "" : "; and ", word);
  if (!command.commands.empty())
    condition += fmt::format("; and not __fish_seen_subcommand_from {}", fmt::join(command.commands, " "));
  return condition;
}

std::string for_fish(const std::vector<CommandWords>& all) {
  std::string text = "# Completes the words of aloft in fish; made by: aloft completions fish\n";
  for (const CommandWords& command : all) {
    const std::string begin = fmt::format("complete -c aloft -n {}", shell_quoted(fish_condition(command)));
    for (const std::string& name : command.commands)
      text += fmt::format("{} -f -a {} -d {}\n", begin, name, shell_quoted(about(all, command.path + " " + name)));
    for (const std::string& value : command.values) text += fmt::format("{} -a {}\n", begin, shell_quoted(value));
    for (const OptionWord& option : command.options) {
      text += fmt::format("{} -l {} -d {}", begin, option.name.substr(2), shell_quoted(option.about));
      if (!option.choices.empty())
        text += fmt::format(" -x -a {}", shell_quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      else if (option.takes_value)
        text += " -r";
      text += '\n';
    }
  }
  return text;
}

}  // namespace

void add_completions(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("completions", "Print what a shell needs to complete the words of aloft");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "The shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([&app, shell, &job] {
    job = [&app, shell] {
      std::vector<CommandWords> all;
      add_words(all, app, app.get_name());
      fmt::print("{}", *shell == "bash" ? for_bash(all) : *shell == "zsh" ? for_zsh(all) : for_fish(all));
      return exit_ok;
    };
  });
}

}  // namespace aloft::cli
