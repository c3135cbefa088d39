#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace aloft::cli {

/// What the chosen subcommand does; returns the exit code.
using Job = std::function<int()>;

/// Each function adds one subcommand to `app`, which sets `job` when the command line names it.
void add_run(CLI::App& app, Job& job);
void add_worker(CLI::App& app, Job& job);
void add_coordinator(CLI::App& app, Job& job);
void add_metrics(CLI::App& app, Job& job);
void add_reproduce(CLI::App& app, Job& job);
void add_swap(CLI::App& app, Job& job);
void add_tournament(CLI::App& app, Job& job);
void add_report(CLI::App& app, Job& job);
void add_validate(CLI::App& app, Job& job);
void add_agents(CLI::App& app, Job& job);
void add_export(CLI::App& app, Job& job);
void add_digest(CLI::App& app, Job& job);
void add_compare(CLI::App& app, Job& job);
void add_import_rdata(CLI::App& app, Job& job);
void add_inspect(CLI::App& app, Job& job);
void add_status(CLI::App& app, Job& job);
void add_keys(CLI::App& app, Job& job);
void add_doctor(CLI::App& app, Job& job);
void add_train(CLI::App& app, Job& job);

/// An experiment file and what the command line changes in it.
struct ExperimentOptions {
  std::filesystem::path file;
  experiment::Overrides overrides;

  /// Adds the options and returns that of the file, which is required.
  CLI::Option& add_to(CLI::App& command);
  [[nodiscard]] experiment::Experiment load() const { return experiment::load(file, overrides); }
};

/// Checks the form of an agent's name before a process is asked for that agent.
[[nodiscard]] CLI::Validator agent_name();

/// Adds "--format" with these choices; the first is the default.
void add_format(CLI::App& command, std::string& format, std::vector<std::string> choices);

}  // namespace aloft::cli
