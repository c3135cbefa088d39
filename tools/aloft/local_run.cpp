#include "tools/aloft/local_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <thread>

#include "common/base/error.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "tools/aloft/children.hpp"

namespace aloft::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_period{100};
constexpr std::chrono::milliseconds stop_limit{4000};
constexpr std::chrono::milliseconds finish_limit{2000};
constexpr std::chrono::milliseconds farewell_limit{3000};
constexpr std::chrono::seconds restart_window{60};
constexpr std::size_t restarts_allowed = 20;  // per process and window: more is a bug, not bad luck

std::filesystem::path own_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// The processes of one run: which there are, how to start each, which to start again.
class System {
 public:
  System(const LocalRun& run, std::string run_name) : run_(run), run_name_(std::move(run_name)) {
    std::filesystem::create_directories(run_.dir / "log");
    const std::string experiment = (run_.dir / "experiment.json").string();
    add("aloft-metrics", "", {"--results", run_.dir.string(), "--experiment", experiment});
    std::vector<std::string> coordinator{"--results", run_.dir.string(), "--experiment",
                                         experiment,  "--fail-fast",     std::to_string(run_.fail_fast)};
    if (run_.shuffled) coordinator.insert(coordinator.end(), {"--trial-order", "shuffled"});
    add("aloft-coordinator", "", coordinator);
    for (unsigned i = 0; i < run_.workers; ++i) {
      const std::string worker = fmt::format("w{}", i);
      for (const char* program : {"aloft-environment", "aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"})
        add(program, worker, {"--worker", worker});
    }
  }

  void start_all() {
    for (const auto& [name, arguments] : commands_) start(name);
  }

  /// Starts again what died. Returns a line for each death; `coordinator_exit` is set when the coordinator is through.
  std::vector<std::string> supervise(std::optional<int>& coordinator_exit) {
    std::vector<Children::Ended> deaths;
    for (const Children::Ended& ended : children_.reap()) {
      if (ended.name == "aloft-coordinator" && ended.signal == 0)
        coordinator_exit = ended.exit_code;
      else if (ended.signal == 0 && ended.exit_code == exit_ok)
        left_.emplace_back(ended, Clock::now());
      else
        deaths.push_back(ended);
    }
    if (coordinator_exit) return {};
    // Who leaves in good order has heard that the run is over; the coordinator follows at once, or else it died.
    std::erase_if(left_, [&](const auto& entry) {
      const bool alone = Clock::now() - entry.second > farewell_limit;
      if (alone) deaths.push_back(entry.first);
      return alone;
    });
    std::vector<std::string> lines;
    for (const Children::Ended& ended : deaths) {
      lines.push_back(fmt::format("{}; starting it again (its log: {})", ended.reason(), log_of(ended.name).string()));
      start_again(ended.name);
    }
    return lines;
  }

  /// Returns the names of processes that had to be killed.
  std::vector<std::string> stop(std::chrono::milliseconds limit) { return children_.stop_all(limit); }

 private:
  void add(const std::string& program, const std::string& worker, std::vector<std::string> more) {
    std::vector<std::string> arguments{(own_folder() / program).string(),
                                       "--run",
                                       run_name_,
                                       "--domain",
                                       std::to_string(run_.domain),
                                       "--log-dir",
                                       (run_.dir / "log").string(),
                                       "--die-with-parent"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    commands_.emplace_back(worker.empty() ? program : program + "-" + worker, std::move(arguments));
  }

  [[nodiscard]] std::filesystem::path log_of(const std::string& name) const {
    return run_.dir / "log" / (name + ".log");
  }

  void start(const std::string& name) {
    const auto command =
        std::find_if(commands_.begin(), commands_.end(), [&](const auto& entry) { return entry.first == name; });
    children_.start(name, command->second, run_.dir / "log" / (name + ".err"));
  }

  void start_again(const std::string& name) {
    std::deque<Clock::time_point>& times = restarts_[name];
    const auto now = Clock::now();
    while (!times.empty() && now - times.front() > restart_window) times.pop_front();
    if (times.size() >= restarts_allowed)
      throw std::runtime_error(fmt::format("{} died {} times within {} s; see {}", name, times.size() + 1,
                                           restart_window.count(), log_of(name).string()));
    times.push_back(now);
    start(name);
  }

  const LocalRun& run_;
  std::string run_name_;
  std::vector<std::pair<std::string, std::vector<std::string>>> commands_;
  std::map<std::string, std::deque<Clock::time_point>> restarts_;
  std::vector<std::pair<Children::Ended, Clock::time_point>> left_;
  Children children_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

bool run_local(const LocalRun& run, const experiment::Experiment& experiment, Progress& progress,
               const std::atomic<bool>& interrupted, std::vector<std::string>& failures) {
  const std::string run_name = run.name.empty() ? fmt::format("{}.{}", experiment.id, getpid()) : run.name;
  bus::BusOptions options;
  options.run = run_name;
  options.process = "aloft";
  options.domain = run.domain;
  const bus::Participant participant(options);
  bus::Reader<wire::RunStatus> statuses(participant);
  statuses.expect_experiment(experiment.id);
  bus::Waiter waiter;
  waiter.add(statuses);

  System system(run, run_name);
  system.start_all();
  std::optional<int> coordinator_exit;
  wire::RunStatus last;
  while (!coordinator_exit && !interrupted) {
    waiter.wait(poll_period);
    statuses.drain([&](const wire::RunStatus& status) {
      last = status;
      progress.update(status.flights_stored(), status.workers_alive(), run.workers, status.message().to_string());
    });
    for (const std::string& line : system.supervise(coordinator_exit)) progress.note(line);
  }
  for (const std::string& name : system.stop(interrupted ? stop_limit : finish_limit))
    progress.note(fmt::format("{} did not stop in time and was killed", name));
  if (coordinator_exit && *coordinator_exit != 0) {
    failures = lines_of(last.message().to_string());
    if (failures.empty())
      failures.push_back(fmt::format("the coordinator ended with exit code {}; see {}", *coordinator_exit,
                                     (run.dir / "log").string()));
  }
  return coordinator_exit == 0;
}

}  // namespace aloft::cli
