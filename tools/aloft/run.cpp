#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/supervise/local_experiment.hpp"
#include "tools/aloft/table_options.hpp"
#include "tools/report/report.hpp"

namespace aloft::cli {
namespace {

struct RunOptions {
  ExperimentOptions experiment;
  FlyingOptions flying;
  std::filesystem::path out;
  std::string format;
  TableOptions table;
};

int run(const RunOptions& options) {
  const experiment::Experiment experiment = options.experiment.load();
  const std::filesystem::path dir =
      options.out.empty() ? std::filesystem::path("results") / experiment.name : options.out;
  const int exit_code = fly_experiment(experiment, dir, options.flying);
  if (options.flying.page.wanted)
    fmt::print(stderr, "The page of a run ends with it; see the flights with: aloft live {}\n", dir.string());
  if (exit_code == exit_interrupted) return exit_code;
  fmt::print("{}", comparison(dir, options.format, options.table.shape()));
  std::fflush(stdout);
  fmt::print(stderr, "{}",
             wrapped(fmt::format("Results: {} (summary.json, summary.csv, results.sqlite, experiment.json{}); see them "
                                 "with: {}aloft report {}",
                                 dir.string(), options.flying.in_process ? "" : ", log/",
                                 report::has_charts() ? "" : "tools/setup.sh && ", dir.string()),
                     text_width(STDERR_FILENO)));
  return exit_code;
}

}  // namespace

void add_run(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "run", "Run an experiment on this machine: starts all services, shows progress, ends with the comparison table");
  auto options = std::make_shared<RunOptions>();
  options->experiment.add_to(*command);
  command->add_option("--out", options->out, "Result folder; an interrupted run in it is resumed [results/NAME]");
  options->flying.add_to(*command);
  command->add_flag("--live", options->flying.page.wanted,
                    "Show the run and its flights in a browser while it flies; prints the address (docs/live.md)");
  command->add_flag("--operator", options->flying.page.with_control,
                    "Let the page of --live order swaps, for those who have the printed address");
  add_format(*command, options->format, {"text", "json"});
  options->table.add_to(*command);
  command->callback([options, &job] { job = [options] { return run(*options); }; });
}

}  // namespace aloft::cli
