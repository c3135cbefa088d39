#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <iostream>

#include "common/base/build_info.hpp"
#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"
#include "services/runtime/plain_log.hpp"
#include "tools/aloft/commands.hpp"

namespace {

std::vector<std::string> names_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// A wrong flag or command: say which, and what was probably meant.
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
  constexpr std::size_t longest = 1000;  // of arguments that it repeats
  std::string path;
  for (const CLI::App* part = command; part != nullptr; part = part->get_parent())
    path = part->get_name() + (path.empty() ? "" : " ") + path;
  fmt::print(stderr, "{}: {}.{}\nRun '{} --help' for the options.\n", path, aloft::plain_text(error.what(), longest),
             hint, path);
  return aloft::exit_bad_input;
}

/// A message may repeat arguments, names and paths.
void tell(const std::exception& error) {
  constexpr std::size_t longest = 4000;
  fmt::print(stderr, "aloft: {}\n", aloft::plain_lines(aloft::beginning_of(error.what(), longest)));
}

/// Standard output is for results: who could not write them has not succeeded.
int with_output_written(int exit_code) {
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good();
  if (written) return exit_code;
  fmt::print(stderr, "aloft: cannot write to standard output; is the disk full that it goes to?\n");
  return exit_code == aloft::exit_ok ? aloft::exit_failure : exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace aloft::cli;
  // Standard output is for results.
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("aloft", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_formatter(aloft::runtime::plain_log("%n: %^%l%$: %v"));
  CLI::App app{
      "Adaptive height optimisation for cellular-connected UAVs: run experiments, look into them, compare agents.",
      "aloft"};
  app.set_version_flag("--version", std::string(aloft::build_id()));
  app.require_subcommand(1);
  app.footer("Start with: aloft run data/experiments/quick.json");
  Job job;
  add_run(app, job);
  add_worker(app, job);
  add_coordinator(app, job);
  add_metrics(app, job);
  add_reproduce(app, job);
  add_status(app, job);
  add_doctor(app, job);
  add_keys(app, job);
  add_swap(app, job);
  add_tournament(app, job);
  add_validate(app, job);
  add_agents(app, job);
  add_inspect(app, job);
  add_export(app, job);
  add_digest(app, job);
  add_compare(app, job);
  add_report(app, job);
  add_import_rdata(app, job);
  add_train(app, job);
  try {
    app.parse(argc, argv);
    return with_output_written(job());
  } catch (const CLI::Success& success) {
    return with_output_written(app.exit(success));
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
