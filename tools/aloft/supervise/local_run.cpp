#include "tools/aloft/supervise/local_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <optional>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/network.hpp"
#include "common/bus/waiter.hpp"
#include "common/store/result_folder.hpp"
#include "services/runtime/sole_coordinator.hpp"
#include "tools/aloft/supervise/processes.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::milliseconds poll_period{100};
constexpr std::chrono::milliseconds stop_limit{4000};
constexpr std::chrono::milliseconds finish_limit{2000};
constexpr std::chrono::milliseconds look_around{500};

void add_services(Processes& processes, const std::filesystem::path& dir, const FlyingOptions& options) {
  const std::vector<std::string> results{"--results", dir.string(), "--experiment", (dir / "experiment.json").string()};
  if (const std::string& server = options.bus.discovery_server; !server.empty()) {
    const bus::Endpoint endpoint = bus::resolve_endpoint(server);
    if (bus::is_local_address(endpoint.address)) {
      bus::check_can_listen(endpoint);
      processes.add("aloft-discovery-server", {});
    }
  }
  processes.add("aloft-metrics", results);
  // The name is new, or RunName has already looked for another coordinator, so this one need not.
  std::vector<std::string> coordinator = results;
  coordinator.insert(coordinator.end(), {"--look-around", "0"});
  coordinator.insert(coordinator.end(), {"--fail-fast", std::to_string(options.fail_fast)});
  if (options.shuffled) coordinator.insert(coordinator.end(), {"--trial-order", "shuffled"});
  processes.add_decider("aloft-coordinator", coordinator);
  const unsigned workers = options.workers_here();
  for (unsigned i = 0; i < workers; ++i)
    processes.add_worker(fmt::format("w{}", i), options.learner_threads_per_worker(), {},
                         options.unpinned ? CoreShare{} : CoreShare{i, workers});
}

/// The run's name and what differs from the defaults.
std::string join_arguments(const bus::BusOptions& place) {
  const bus::BusOptions defaults;
  std::string text = place.run;
  if (place.domain != defaults.domain) text += fmt::format(" --domain {}", place.domain);
  if (place.interfaces != defaults.interfaces) text += " --interface THEIRS";
  if (!place.discovery_server.empty()) text += " --discovery-server " + place.discovery_server;
  if (!place.secure.empty()) text += " --secure THEIRS";
  return text;
}

/// Ends the run if its results are gone, before a restarted collector makes a new folder.
void check_in_place(const store::FolderWatch& results, Processes& processes) {
  try {
    results.check();
  } catch (const store::ResultsGone&) {
    processes.stop(stop_limit);
    throw;
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Why a process ended: what comes after its name in the last line that it wrote.
std::string last_words(const std::filesystem::path& errors, const std::string& program) {
  const std::vector<std::string> lines = lines_of(read_file(errors));
  const std::string line = lines.empty() ? "" : lines.back();
  const std::size_t at = line.find(program + ": ");
  return at == std::string::npos ? line : line.substr(at + program.size() + 2);
}

}  // namespace

RunName::RunName(const bus::BusOptions& place, const std::atomic<bool>& interrupted)
    : claim_(place.run, place.domain, "run") {
  bus::BusOptions here = place;
  here.process = "aloft";
  const bus::Participant participant(here);
  (void)runtime::SoleCoordinator(participant).take(claim_, look_around, [&interrupted] { return interrupted.load(); });
}

bool run_local(const std::filesystem::path& dir, const FlyingOptions& options, const experiment::Experiment& experiment,
               Progress& progress, const std::atomic<bool>& interrupted, std::vector<std::string>& failures) {
  const unsigned workers = options.workers_here();
  bus::BusOptions place = options.bus;
  if (place.run.empty()) place.run = fmt::format("{}.{}", experiment.id, getpid());
  place.process = "aloft";
  const bus::Participant participant(place);
  bus::Reader<wire::RunStatus> statuses(participant);
  statuses.expect_experiment(experiment.id);
  bus::Waiter waiter;
  waiter.add(statuses);

  if (workers == 0 || !options.bus.run.empty())
    progress.note(fmt::format("Workers join with: aloft worker --join {}", join_arguments(place)));
  const store::FolderWatch results = store::watch_results(dir);
  Processes processes(place, dir / "log");
  add_services(processes, dir, options);
  processes.start_all();
  std::optional<PageProcess> page;
  if (options.page.wanted) page.emplace(dir, place, options.page);
  wire::RunStatus last;
  while (!processes.decision() && !interrupted) {
    waiter.wait(poll_period);
    check_in_place(results, processes);
    statuses.drain([&](const wire::RunStatus& status) {
      last = status;
      // The caller reports the last message.
      progress.update(status.flights_stored(), status.workers_alive(), workers,
                      status.state() == wire::RUN_RUNNING ? status.message().to_string() : "");
    });
    progress.tick();
    for (const std::string& line : processes.supervise()) progress.note(line);
    if (page)
      for (const std::string& line : page->news()) progress.note(line);
  }
  for (const std::string& name : processes.stop(interrupted ? stop_limit : finish_limit))
    progress.note(fmt::format("{} did not stop in time and was killed", name));
  const std::optional<int> coordinator_exit = processes.decision();
  if (coordinator_exit == exit_bad_input)
    throw InputError(last_words(dir / "log" / "aloft-coordinator.err", "aloft-coordinator"));
  if (coordinator_exit && *coordinator_exit != 0) {
    failures = lines_of(last.message().to_string());
    if (failures.empty())
      failures.push_back(
          fmt::format("the coordinator ended with exit code {}; see {}", *coordinator_exit, (dir / "log").string()));
  }
  return coordinator_exit == 0;
}

}  // namespace aloft::cli
