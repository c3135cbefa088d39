#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/text_layout.hpp"
#include "common/bus/participant.hpp"
#include "common/experiment/experiment.hpp"
#include "tools/aloft/supervise/page_process.hpp"

namespace aloft::cli {

/// How an experiment is flown on this machine.
struct FlyingOptions {
  std::optional<unsigned> workers{};  ///< none: one per core, as far as they fit
  unsigned learner_threads = 0;       ///< of each worker; 0: an equal share of the cores
  unsigned fail_fast = 0;
  bool unpinned = false;
  bool in_process = false;
  bool shuffled = false;
  PageOptions page;
  bus::BusOptions bus;

  void add_to(CLI::App& command);
  [[nodiscard]] unsigned workers_here() const;  ///< with in_process: threads
  [[nodiscard]] unsigned learner_threads_per_worker() const;
  /// InputError if this machine cannot fly the experiment with these options; nothing is written.
  void check(const experiment::Experiment& experiment) const;
};

/// Flies the flights of this experiment that `dir` lacks and shows progress; Ctrl-C stops it. Writes summary.json and
/// summary.csv unless interrupted. Returns the exit code (base/error.hpp). InputError if `dir` belongs to another
/// experiment.
int fly_experiment(const experiment::Experiment& experiment, const std::filesystem::path& dir,
                   const FlyingOptions& options);

/// Flies one experiment after the other, each into its own folder `out`/NAME, and calls `flown` with that folder. Stops
/// at the first that does not end with exit_ok. Returns the last exit code.
int fly_experiments(const std::vector<experiment::Experiment>& all, const std::filesystem::path& out,
                    const FlyingOptions& options,
                    const std::function<void(const std::filesystem::path& dir)>& flown = nullptr);

/// The comparison of a result folder as aligned text, or "json": the content of summary.json.
[[nodiscard]] std::string comparison(const std::filesystem::path& dir, const std::string& format,
                                     const TableShape& shape);

}  // namespace aloft::cli
