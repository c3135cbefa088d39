#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "common/base/error.hpp"
#include "common/experiment/summary.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/in_process.hpp"
#include "tools/aloft/local_run.hpp"

namespace aloft::cli {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

extern "C" void note_interrupt(int /*signal*/) {
  interrupted = true;
}

struct RunOptions {
  ExperimentOptions experiment;
  std::filesystem::path out;
  unsigned workers = std::max(1U, std::thread::hardware_concurrency());
  unsigned fail_fast = 0;
  bool in_process = false;
  bool shuffled = false;
  int domain = 0;
  std::string format;
};

void write_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path temporary = file.string() + ".part";
  std::ofstream(temporary) << text;
  std::filesystem::rename(temporary, file);
}

/// Writes summary.json and summary.csv, prints the table.
void report(const std::filesystem::path& dir, const std::string& format) {
  const auto results = store::ResultStore::open_for_reading(dir);
  const nlohmann::ordered_json summary = store::summarise(results);
  write_file(dir / "summary.json", summary.dump(2) + "\n");
  write_file(dir / "summary.csv", experiment::summary_csv(summary));
  fmt::print("{}", format == "json" ? summary.dump(2) + "\n" : experiment::summary_table(summary));
}

int run(const RunOptions& options) {
  const experiment::Experiment experiment = options.experiment.load();
  const std::filesystem::path dir =
      options.out.empty() ? std::filesystem::path("results") / experiment.name : options.out;
  const std::uint64_t total =
      std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size();
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);

  std::vector<std::string> failures;
  bool complete = false;
  {
    auto results = std::make_unique<store::ResultStore>(store::ResultStore::open_for_writing(dir, experiment));
    const std::uint64_t already_done = results->keys().size();
    complete = already_done == total;
    Progress progress(total, already_done);
    if (already_done > 0)
      progress.note(fmt::format("{}: {} of {} flights are already there", dir.string(), already_done, total));
    if (!complete && options.in_process) {
      InProcessOutcome outcome = run_in_process(*results, options.workers, options.fail_fast, progress, interrupted);
      failures = std::move(outcome.failures);
      complete = results->keys().size() == total;
    } else if (!complete) {
      results.reset();  // the metrics service is the one writer
      const LocalRun local{dir, options.workers, options.fail_fast, options.shuffled, options.domain};
      complete = run_local(local, experiment, progress, interrupted, failures);
    }
    progress.finish();
  }

  for (const std::string& line : failures) fmt::print(stderr, "failed: {}\n", line);
  if (interrupted) {
    fmt::print(stderr, "Interrupted. The same command goes on where this one stopped; results so far: {}\n",
               dir.string());
    return exit_interrupted;
  }
  report(dir, options.format);
  fmt::print(stderr, "Results: {} (summary.json, summary.csv, results.sqlite, experiment.json{})\n", dir.string(),
             options.in_process ? "" : ", log/");
  return complete && failures.empty() ? exit_ok : exit_failure;
}

}  // namespace

void add_run(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "run", "Run an experiment on this machine: starts all services, shows progress, ends with the comparison table");
  auto options = std::make_shared<RunOptions>();
  options->experiment.add_to(*command);
  command->add_option("--out", options->out, "Result folder; an interrupted run in it is resumed [results/NAME]");
  command
      ->add_option("--workers", options->workers,
                   "Worker groups (environment, channel, agents); with --in-process: threads")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--fail-fast", options->fail_fast,
                   "Stop after this many failed trials; 0: fly the rest, then report")
      ->capture_default_str();
  command->add_flag("--in-process", options->in_process, "Fly in this process, without DDS: the same bytes");
  command->add_flag("--shuffled", options->shuffled, "Hand out the trials in a shuffled order: the same bytes");
  command->add_option("--domain", options->domain, "DDS domain")->check(CLI::Range(0, 101))->capture_default_str();
  add_format(*command, options->format, {"text", "json"});
  command->callback([options, &job] { job = [options] { return run(*options); }; });
}

}  // namespace aloft::cli
