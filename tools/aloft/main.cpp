#include <fmt/format.h>

#include <cstdio>

#include "common/agents/load_plugin.hpp"
#include "common/base/build_info.hpp"
#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/participant.hpp"
#include "services/runtime/help_format.hpp"
#include "services/runtime/plugin_flag.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/completions.hpp"
#include "tools/aloft/help.hpp"
#include "tools/aloft/status_line.hpp"

namespace {

std::vector<std::string> names_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Reports a wrong flag or command, and what was probably meant.
int report_usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const std::vector<std::string> names = names_of(*command);
  std::string hint;
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    for (const std::string& argument : arguments) {
      const std::string word = argument.substr(0, argument.find('='));
      const bool looked_for = word.rfind("--", 0) == 0 || command == &app;
      if (looked_for && hint.empty() && std::find(names.begin(), names.end(), word) == names.end())
        hint = aloft::did_you_mean(word, names);
    }
  }
  constexpr std::size_t longest = 1000;  // the error repeats arguments
  std::string path;
  for (const CLI::App* part = command; part != nullptr; part = part->get_parent())
    path = fmt::format("{}{}{}", part->get_name(), path.empty() ? "" : " ", path);
  fmt::print(stderr, "{}: {}.{}\nRun '{} --help' for the options.\n", path, aloft::plain_text(error.what(), longest),
             hint, path);
  return aloft::exit_bad_input;
}

/// A message may repeat arguments, names and paths.
void tell(const std::exception& error) {
  aloft::cli::StatusLine::of_process().finish();
  constexpr std::size_t longest = 4000;
  fmt::print(stderr, "aloft: {}\n", aloft::plain_lines(aloft::beginning_of(error.what(), longest)));
}

/// The commands in the order of the help.
void add_commands(CLI::App& app, aloft::cli::Job& job) {
  using namespace aloft::cli;
  app.formatter(std::make_shared<aloft::runtime::HelpFormatter>());  // which the commands inherit
  app.set_version_flag("--version", fmt::format("{}, {}", aloft::build_id(), aloft::bus::middleware()));
  app.require_subcommand(1);
  const auto add_group = [&](const char* heading, std::initializer_list<void (*)(CLI::App&, Job&)> commands) {
    const std::size_t before = app.get_subcommands({}).size();
    for (const auto add : commands) add(app, job);
    const std::vector<CLI::App*> all = app.get_subcommands({});
    for (std::size_t i = before; i < all.size(); ++i) all[i]->group(heading);
  };
  add_group("Fly experiments", {add_run, add_validate, add_tournament, add_reproduce});
  add_group("Look at results", {add_report, add_live, add_compare, add_export, add_digest});
  add_group("See what is there", {add_agents, add_inspect, add_status, add_doctor});
  add_group("Several machines, and changes in mid-flight",
            {add_coordinator, add_metrics, add_worker, add_swap, add_keys});
  add_group("Data and models", {add_import_rdata, add_import_scatter, add_import_map, add_train});
  add_group("Help", {add_help, add_completions});
  add_examples(app);
}

/// The commands that read experiments or results, or list agents, take --plugin.
void add_plugin_flags(CLI::App& app, std::vector<std::string>& plugins) {
  for (const char* name : {"run", "validate", "tournament", "report", "live", "compare", "export", "digest", "agents",
                           "coordinator", "metrics", "worker"})
    aloft::runtime::add_plugin_flag(*app.get_subcommand(name), plugins);
  for (const char* name : {"world", "table"})
    aloft::runtime::add_plugin_flag(*app.get_subcommand("inspect")->get_subcommand(name), plugins);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace aloft::cli;
  log_above_status_line();  // standard output is for results
  CLI::App app{
      "Adaptive height optimisation for cellular-connected UAVs: run experiments, look into them, compare agents.",
      "aloft"};
  Job job;
  add_commands(app, job);
  std::vector<std::string> plugins;
  add_plugin_flags(app, plugins);
  if (argc <= 1) {
    fmt::print(stderr, "{}", app.help());
    return aloft::exit_bad_input;
  }
  try {
    app.parse(argc, argv);
    for (const std::string& plugin : plugins) aloft::agents::load_plugin(plugin);
    return aloft::runtime::with_output_written(job(), "aloft");  // standard output is for results
  } catch (const CLI::Success& success) {
    return aloft::runtime::with_output_written(app.exit(success), "aloft");
  } catch (const CLI::ParseError& error) {
    return report_usage_error(app, error, std::vector<std::string>(argv + 1, argv + argc));
  } catch (const aloft::InputError& error) {
    tell(error);
    return aloft::exit_bad_input;
  } catch (const std::exception& error) {
    tell(error);
    return aloft::exit_failure;
  }
}
