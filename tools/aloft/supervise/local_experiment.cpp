#include "tools/aloft/supervise/local_experiment.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "common/base/cores.hpp"
#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/terminal.hpp"
#include "common/experiment/summary.hpp"
#include "common/experiment/warnings.hpp"
#include "common/security/keys.hpp"
#include "common/store/result_store.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/in_process.hpp"
#include "tools/aloft/interrupt.hpp"
#include "tools/aloft/supervise/local_run.hpp"
#include "tools/live/live_page.hpp"

namespace aloft::cli {
namespace {

// Each worker is four processes; the rest are coordinator, collector, discovery server and this process.
constexpr unsigned max_workers = (bus::max_processes - 4) / 4;

constexpr std::chrono::milliseconds page_limit{5000};

/// Counts the flights in the database, whatever the coordinator has reported.
bool all_there(const std::filesystem::path& dir, std::vector<std::string>& failures) {
  const auto results = store::ResultStore::open_for_reading(dir);
  const store::Shortfall missing = store::shortfall(results);
  if (missing.flights > 0)
    failures.push_back(
        fmt::format("in '{}' {}; the same command flies them", dir.string(), missing.text(results.experiment())));
  return missing.flights == 0;
}

/// Returns true if every flight is stored; trials that failed for good are added to `failures`. `made` is set to the
/// files and folders that had to be made.
bool fly_missing(const experiment::Experiment& experiment, const std::filesystem::path& dir,
                 const FlyingOptions& options, const std::atomic<bool>& interrupted, std::vector<std::string>& failures,
                 store::MadeResults& made) {
  const std::uint64_t total =
      std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size();
  auto results = std::make_unique<store::ResultStore>(store::ResultStore::open_for_writing(dir, experiment));
  made = results->made();
  const std::uint64_t already_done = results->keys().size();
  Progress progress(total, already_done);
  if (already_done > 0)
    progress.note(fmt::format("{}: {} of {} flights are already there", dir.string(), already_done, total));
  bool complete = already_done == total;
  if (!complete && options.in_process) {
    std::optional<PageProcess> page;
    if (options.page.wanted) {
      bus::BusOptions no_run;
      no_run.run.clear();
      for (const std::string& line : page.emplace(dir, no_run, options.page).first_news(page_limit))
        progress.note(line);
    }
    failures =
        run_in_process(*results, options.workers_here(), options.shuffled, options.fail_fast, progress, interrupted);
    complete = results->keys().size() == total;
  } else if (!complete) {
    results.reset();  // the metrics service is the one writer
    complete = run_local(dir, options, experiment, progress, interrupted, failures) && all_there(dir, failures);
  }
  progress.finish();
  return complete;
}

}  // namespace

unsigned FlyingOptions::workers_here() const {
  return workers.value_or(in_process ? usable_cores() : std::min(usable_cores(), max_workers));
}

unsigned FlyingOptions::learner_threads_per_worker() const {
  return learner_threads > 0 ? learner_threads : std::max(1U, usable_cores() / std::max(1U, workers_here()));
}

void FlyingOptions::check(const experiment::Experiment& experiment) const {
  if (page.wanted) (void)live::page_routes();  // it must have been built
  if (page.with_control && !page.wanted)
    throw InputError("--operator is for the page in a browser; add --live, or order swaps with: aloft swap");
  if (page.with_control && in_process)
    throw InputError("--operator: with --in-process there are no workers to give orders to; leave one of the two out");
  if (in_process) check_flies_in_process(experiment);
  if (in_process && workers_here() == 0)
    throw InputError("--workers 0: --in-process needs a thread at least; use 1 to 64");
  if (!in_process && workers_here() > max_workers)
    throw InputError(
        "--workers {}: a worker is four processes, and {} processes fit in a DDS domain, so use at most {} "
        "workers, or --in-process, where they are threads",
        workers_here(), bus::max_processes, max_workers);
  if (!bus.secure.empty())  // services that refuse their keys would be restarted again and again
    for (const security::Role role : security::all_roles)
      if (role != security::Role::run_operator || page.with_control) (void)security::check_keys(bus.secure, role);
}

void FlyingOptions::add_to(CLI::App& command) {
  command
      .add_option(
          "--workers", workers,
          fmt::format("Worker groups (environment, channel, agents) started here, at most {}; 0: only those that "
                      "join; with --in-process: threads [one per core]",
                      max_workers))
      ->check(runtime::whole_number(0, 64));
  command
      .add_option("--learner-threads", learner_threads,
                  "Flights that each worker learns from at the same time; the bytes are the same [cores / workers]")
      ->check(runtime::whole_number(1, 256));
  command.add_flag("--unpinned", unpinned,
                   "Let workers move between cores, instead of keeping each on an equal share of them: slower, but "
                   "better when other programs occupy some cores");
  command.add_option("--fail-fast", fail_fast, "Stop after this many failed trials; 0: fly the rest, then report")
      ->check(runtime::whole_number(0, 1'000'000'000))
      ->capture_default_str();
  command.add_flag("--in-process", in_process, "Fly in this process, without DDS: the same bytes");
  command.add_flag("--shuffled", shuffled, "Hand out the trials in a shuffled order: the same bytes");
  bus.run.clear();
  command
      .add_option("--run", bus.run,
                  "Name of the run on the bus, for workers and external agents that join it [one of its own]")
      ->check(runtime::bus_name());
  runtime::add_bus_flags(command, bus);
}

int fly_experiment(const experiment::Experiment& experiment, const std::filesystem::path& dir,
                   const FlyingOptions& options) {
  options.check(experiment);
  const std::atomic<bool>& interrupted = note_interrupts();
  for (const experiment::Warning& warning : experiment::warnings(experiment))
    fmt::print(stderr, "{}", wrapped(warning.text, text_width(STDERR_FILENO), "warning: ", "  "));
  std::optional<RunName> name;
  if (!options.in_process && !options.bus.run.empty()) name.emplace(options.bus, interrupted);
  std::vector<std::string> failures;
  bool complete = false;
  store::MadeResults made;
  try {
    complete = fly_missing(experiment, dir, options, interrupted, failures, made);
  } catch (const InputError&) {
    store::take_back(made);
    throw;
  }
  for (const std::string& line : failures)
    fmt::print(stderr, "{}", wrapped(plain_text(line), text_width(STDERR_FILENO), "failed: ", "  "));
  if (interrupted) {
    fmt::print(stderr, "{}",
               wrapped(fmt::format("Interrupted. The same command goes on where this one stopped; results so far: {}",
                                   dir.string()),
                       text_width(STDERR_FILENO)));
    return exit_interrupted;
  }
  store::write_summary(dir);
  return complete && failures.empty() ? exit_ok : exit_failure;
}

int fly_experiments(const std::vector<experiment::Experiment>& all, const std::filesystem::path& out,
                    const FlyingOptions& options, const std::function<void(const std::filesystem::path& dir)>& flown) {
  for (const experiment::Experiment& experiment : all) options.check(experiment);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const experiment::Experiment& experiment = all[i];
    fmt::print(stderr, "{} of {}: {}, {} flights\n", i + 1, all.size(), experiment.name,
               std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size());
    const std::filesystem::path dir = out / experiment.name;
    const int exit_code = fly_experiment(experiment, dir, options);
    if (exit_code != exit_ok) return exit_code;
    if (flown) flown(dir);
  }
  return exit_ok;
}

std::string comparison(const std::filesystem::path& dir, const std::string& format, const TableShape& shape) {
  const nlohmann::ordered_json summary = store::summarise(store::ResultStore::open_for_reading(dir));
  return format == "json" ? summary.dump(2) + "\n" : experiment::summary_table(summary, shape);
}

}  // namespace aloft::cli
