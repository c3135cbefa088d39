#include "tools/aloft/supervise/processes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "common/base/error.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/plugin_flag.hpp"
#include "services/runtime/standstill_watch.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::seconds farewell_limit{8};  // longer than the coordinator waits for absent processes
constexpr std::chrono::seconds restart_window{60};
constexpr std::size_t restarts_allowed = 20;  // per process and window: more is a bug, not bad luck

}  // namespace

std::filesystem::path program_path(const std::string& program) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
}

Processes::Processes(bus::BusOptions place, std::filesystem::path log_dir)
    : place_(std::move(place)), log_dir_(std::move(log_dir)) {}

void Processes::add_decider(const std::string& program, const std::vector<std::string>& more) {
  add(program, more);
  decider_ = program;
}

void Processes::add_worker(const std::string& worker, unsigned learner_threads, const std::vector<std::string>& agents,
                           const CoreShare& cores) {
  std::vector<std::string> only;
  if (!agents.empty()) only = {"--agents", fmt::format("{}", fmt::join(agents, ","))};
  std::vector<std::string> learners = only;
  learners.insert(learners.end(), {"--threads", std::to_string(learner_threads)});
  add("aloft-environment", {}, worker, cores);
  add("aloft-channel", only, worker, cores);
  add("aloft-learning-agent", learners, worker, cores);
  add("aloft-baseline-agent", only, worker, cores);
}

void Processes::add(const std::string& program, const std::vector<std::string>& more, const std::string& worker,
                    const CoreShare& cores) {
  std::vector<std::string> arguments{program_path(program).string(), "--log-dir", log_dir_.string(),
                                     "--die-with-parent"};
  const std::vector<std::string> place = runtime::bus_arguments(place_);
  arguments.insert(arguments.end(), place.begin(), place.end());
  const std::vector<std::string> plugins = runtime::plugin_arguments();
  arguments.insert(arguments.end(), plugins.begin(), plugins.end());
  if (!worker.empty()) arguments.insert(arguments.end(), {"--worker", worker});
  arguments.insert(arguments.end(), more.begin(), more.end());
  commands_.push_back({worker.empty() ? program : program + "-" + worker, std::move(arguments), cores});
}

void Processes::start_all() {
  std::filesystem::create_directories(log_dir_);
  for (const Command& command : commands_) start(command.name);
}

std::vector<std::string> Processes::supervise() {
  std::vector<Children::Ended> deaths;
  for (const Children::Ended& ended : children_.reap()) {
    if (ended.name == decider_ && ended.signal == 0 && ended.exit_code != runtime::exit_start_again)
      decision_ = ended.exit_code;
    else if (ended.signal == 0 && ended.exit_code == exit_ok)
      left_.emplace_back(ended, Clock::now());
    else
      deaths.push_back(ended);
  }
  if (decision_ || (children_.empty() && deaths.empty())) return {};
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

void Processes::start(const std::string& name) {
  const auto command = std::ranges::find(commands_, name, &Command::name);
  const OnCores pinned(command->cores);
  children_.start(name, command->arguments, log_dir_ / (name + ".err"));
}

void Processes::start_again(const std::string& name) {
  std::deque<Clock::time_point>& times = restarts_[name];
  const auto now = Clock::now();
  while (!times.empty() && now - times.front() > restart_window) times.pop_front();
  if (times.size() >= restarts_allowed)
    throw std::runtime_error(fmt::format("{} died {} times within {} s; see {}", name, times.size() + 1,
                                         restart_window.count(), log_of(name).string()));
  times.push_back(now);
  start(name);
}

}  // namespace aloft::cli
