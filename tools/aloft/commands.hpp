#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace aloft::cli {

/// What the chosen subcommand does; returns the exit code.
using Job = std::function<int()>;

/// Adds one subcommand to `app`, which sets `job` when the command line names it.
using AddCommand = void(CLI::App& app, Job& job);
AddCommand add_run, add_worker, add_coordinator, add_metrics, add_reproduce, add_swap, add_tournament, add_report,
    add_validate, add_agents, add_export, add_digest, add_compare, add_import_rdata, add_import_scatter, add_import_map,
    add_inspect, add_status, add_keys, add_doctor, add_train, add_live;
AddCommand add_inspect_link;  // of `inspect`

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
