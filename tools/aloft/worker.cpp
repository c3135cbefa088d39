#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <ctime>
#include <optional>

#include "common/base/cores.hpp"
#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/process_name.hpp"
#include "common/base/seconds.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "services/runtime/notifier.hpp"
#include "services/runtime/run_follower.hpp"
#include "services/runtime/standstill_watch.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/supervise/processes.hpp"

namespace aloft::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_period{100};
constexpr std::chrono::milliseconds stop_limit{4000};
constexpr std::chrono::milliseconds farewell_limit{2000};
constexpr std::chrono::milliseconds namesake_time{1000};  // two status periods of a worker
constexpr std::chrono::seconds patience{4};

struct WorkerOptions {
  bus::BusOptions bus;
  std::string name;
  bool named = false;  // the user gave the name
  std::vector<std::string> agents;
  unsigned learner_threads = usable_cores();
  std::filesystem::path log_dir;
  double wait_s = 300.0;
};

/// Differs between hosts, and between workers of one host.
std::string unique_name() {
  std::string name = this_process().host.substr(0, 48);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.'; }, '_');
  return fmt::format("{}-{}", name, getpid());
}

void say(const std::string& line) {
  fmt::print(stderr, "{}\n", line);
  std::fflush(stderr);
}

/// What a worker group sees of the run that it joins, and its four processes.
class Membership {
 public:
  explicit Membership(const WorkerOptions& options)
      : options_(options),
        participant_(options.bus),
        waiter_(stop_),
        processes_(options.bus, options.log_dir),
        seen_at_(std::time(nullptr)) {
    waiter_.add(follower_.reader());
    waiter_.add(statuses_);
    processes_.add_worker(options.name, options.learner_threads, options.agents);
  }

  int run() {
    notifier_.ready(fmt::format("looks for run {}", options_.bus.run));
    if (!wait_for_coordinator()) return exit_interrupted;
    if (options_.named) refuse_namesake();
    if (!follower_.over() && !stop_.requested()) processes_.start_all();
    while (!stop_.requested() && !follower_.over() && !processes_.all_left()) {
      listen();
      for (const std::string& line : processes_.supervise()) say(line);
    }
    leave();
    if (stop_.interrupted()) return exit_interrupted;
    say(fmt::format("run {} {}", options_.bus.run, stopped_ ? "was stopped; join again when it goes on" : "is over"));
    return stopped_ ? exit_failure : exit_ok;
  }

 private:
  /// False if a signal came first.
  bool wait_for_coordinator() {
    while (!follower_.experiment() && !follower_.over() && !stop_.requested()) listen();
    if (stop_.requested()) return false;
    if (!follower_.over())
      say(fmt::format("worker {} joins run {}; logs: {}", options_.name, options_.bus.run, options_.log_dir.string()));
    return true;
  }

  void listen() {
    waiter_.wait(poll_period);
    notifier_.alive();
    if (follower_.update()) check_agents(*follower_.experiment());
    hear_statuses();
    const auto silence = Clock::now() - heard_;
    const double silence_s = seconds(silence);
    const std::string missing = fmt::format("no coordinator of run '{}' for {:.0f} s, since {:%Y-%m-%d %H:%M:%S}",
                                            options_.bus.run, silence_s, fmt::localtime(seen_at_));
    if (silence > patience && !told_missing_) {
      say(missing + fmt::format("; waiting for it, at most {:.0f} s (--wait)", options_.wait_s));
      told_missing_ = true;
    }
    if (silence_s > options_.wait_s)
      throw std::runtime_error(missing +
                               ": gave up. Are the names of the runs the same, and --domain, --interface and "
                               "--discovery-server? Start it with: aloft coordinator EXPERIMENT --run " +
                               options_.bus.run);
  }

  void hear_statuses() {
    statuses_.drain([this](const wire::RunStatus& status) {
      stopped_ = status.state() == wire::RUN_STOPPING;
      if (follower_.experiment()) hear();  // without the experiment, nothing can be flown
    });
  }

  void hear() {
    if (told_missing_) say(fmt::format("the coordinator of run {} is there", options_.bus.run));
    heard_ = Clock::now();
    seen_at_ = std::time(nullptr);
    told_missing_ = false;
  }

  void check_agents(const experiment::Experiment& experiment) const {
    std::vector<std::string> known;
    known.reserve(experiment.agents.size());
    for (const agents::AgentSpec& spec : experiment.agents) known.push_back(spec.name);
    for (const std::string& agent : options_.agents)
      if (std::ranges::find(known, agent) == known.end())
        throw InputError("--agents {}: the experiment '{}' of run {} has no such agent; it has: {}.{}", agent,
                         experiment.name, options_.bus.run, fmt::join(known, ", "), did_you_mean(agent, known));
  }

  /// Two workers of one name would answer each other's questions.
  void refuse_namesake() {
    bus::Reader<wire::WorkerStatus> workers(participant_);
    const auto until = Clock::now() + namesake_time;
    while (Clock::now() < until && !stop_.requested()) {
      listen();
      workers.drain([this](const wire::WorkerStatus& status) {
        if (status.worker() == options_.name && status.capacity() > 0)
          throw InputError("--name {}: run {} has a worker of that name already, on host {} (process {})",
                           options_.name, options_.bus.run, plain_text(wire::view(status.host())), status.pid());
      });
    }
  }

  void leave() {
    const auto until = Clock::now() + farewell_limit;
    while (!stop_.requested() && !processes_.all_left() && Clock::now() < until) {
      waiter_.wait(poll_period);
      hear_statuses();
      processes_.supervise();
    }
    for (const std::string& name : processes_.stop(stop_limit))
      say(fmt::format("{} did not stop in time and was killed", name));
  }

  const WorkerOptions& options_;
  StopSignal stop_;  // before any other thread
  runtime::Notifier notifier_;
  bus::Participant participant_;
  runtime::RunFollower follower_{participant_};
  bus::Reader<wire::RunStatus> statuses_{participant_};
  bus::Waiter waiter_;
  Processes processes_;
  Clock::time_point heard_ = Clock::now();
  std::time_t seen_at_;  // the same as time of day
  bool told_missing_ = false;
  bool stopped_ = false;  // by a signal to its coordinator; it can be resumed
};

int work(WorkerOptions options) {
  spdlog::set_level(spdlog::level::err);
  options.named = !options.name.empty();
  if (!options.named) options.name = unique_name();
  if (options.log_dir.empty()) options.log_dir = std::filesystem::path("log") / options.name;
  options.bus.process = "aloft-worker-" + options.name;
  Membership membership(options);
  std::optional<runtime::StandstillWatch> watch;
  if (const auto limit = bus::longest_standstill(options.bus))
    watch.emplace(*limit, runtime::end_to_be_started_again());
  return membership.run();
}

}  // namespace

void add_worker(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "worker", "Join a run from this machine with one worker: environment, channel and agents; ends with the run");
  auto options = std::make_shared<WorkerOptions>();
  command->add_option("--join", options->bus.run, "Name of the run: --run of its coordinator, or of aloft run")
      ->required()
      ->check(runtime::bus_name());
  command->add_option("--agents", options->agents, "Fly only these agents of the experiment, e.g. dqn,min-height [all]")
      ->delimiter(',')
      ->check(agent_name());
  command
      ->add_option("--learner-threads", options->learner_threads,
                   "Flights learnt from at the same time; give each of several workers on one host its share of the "
                   "cores [one per core]")
      ->check(runtime::whole_number(1, 256));
  command->add_option("--name", options->name, "Name of the worker, unique in the run [HOST-PID]")
      ->check(runtime::bus_name());
  command->add_option("--log-dir", options->log_dir, "Folder for the logs of its processes [log/NAME]");
  command
      ->add_option("--wait", options->wait_s,
                   "Time in seconds to wait for a coordinator, at the start or after it went silent")
      ->check(runtime::number(1, 1e6))
      ->capture_default_str();
  runtime::add_bus_flags(*command, options->bus);
  command->callback([options, &job] { job = [options] { return work(*options); }; });
}

}  // namespace aloft::cli
