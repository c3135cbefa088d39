#include "services/agent_host/agent_host.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/bus/convert.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/warnings.hpp"
#include "services/agent_host/pilot.hpp"
#include "services/agent_host/thread_pool.hpp"
#include "services/runtime/run_follower.hpp"

namespace aloft::agent_host {
namespace {

using Clock = std::chrono::steady_clock;
using Verdict = Pilot::Verdict;

constexpr std::chrono::milliseconds status_period{500};
constexpr std::chrono::milliseconds liveliness_period{100};

/// Proves that this process lives, also while an agent thinks for long.
class LivelinessTimer {
 public:
  explicit LivelinessTimer(bus::Writer<wire::HeightCommand>& commands)
      : thread_([this, &commands] {
          std::unique_lock lock(mutex_);
          while (!ending_) {
            commands.assert_liveliness();
            changed_.wait_for(lock, liveliness_period);
          }
        }) {}
  ~LivelinessTimer() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  LivelinessTimer(const LivelinessTimer&) = delete;
  LivelinessTimer& operator=(const LivelinessTimer&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_ = false;
  std::thread thread_;
};

/// For agents that remember earlier flights.
struct Memories {
  explicit Memories(const bus::Participant& participant)
      : requests(participant), stored(participant), handed_over(participant) {}
  bus::Writer<wire::MemoryRequest> requests;
  bus::Reader<wire::StoredMemory> stored;
  bus::Writer<wire::FlightMemory> handed_over;
};

}  // namespace

struct AgentHost::State {
  State(const bus::BusOptions& place, const AgentHostOptions& wanted, bus::StopSignal& stop_signal)
      : options(wanted), stop(stop_signal), participant(place), commands(participant, {.strength = wanted.strength}) {
    waiter.add(follower.reader());
    waiter.add(reports);
    if (options.threads > 0) pool.emplace(options.threads);
  }

  void run() {
    auto next_status = Clock::now();
    while (!stop.requested() && !follower.over()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_status - Clock::now());
      waiter.wait(std::max(left, std::chrono::milliseconds(0)));
      if (follower.update()) begin();
      if (profiles) profiles->drain([this](const wire::HeightProfile& profile) { on_profile(profile); });
      if (memories) memories->stored.drain([this](const wire::StoredMemory& memory) { on_memory(memory); });
      reports.drain([this](const wire::ChannelReport& report) { on_report(report); });
      finish_thoughts();
      if (Clock::now() < next_status) continue;
      publish_status(wire::AGENT_READY);
      next_status = Clock::now() + status_period;
    }
    pool.reset();
    publish_status(wire::AGENT_STOPPED);
  }

  void begin() {
    experiment = follower.experiment();
    reports.expect_experiment(experiment->id);
    for (const agents::AgentSpec& spec : experiment->agents) serve(spec);
    for (const experiment::Warning& warning : experiment::warnings(*experiment))
      if (std::any_of(served.begin(), served.end(), [&](const auto* spec) { return spec->name == warning.agent; }))
        spdlog::warn(warning.text);
    publish_status(wire::AGENT_READY);
  }

  void serve(const agents::AgentSpec& spec) {
    const agents::AgentType& type = agents::agent_type(spec.type);
    if (type.foreign || type.learns != options.learners) return;
    if (!options.agents.empty() &&
        std::find(options.agents.begin(), options.agents.end(), spec.name) == options.agents.end())
      return;
    served.push_back(&spec);
    spdlog::info("serves agent {}", spec.name);
    // Only a process that serves a privileged agent joins the partition where the future is told.
    if (type.privilege != agents::Privilege::none && !profiles) {
      profiles.emplace(participant);
      waiter.add(*profiles);
    }
    if (spec.lineages() > 0) {
      if (!memories) waiter.add(memories.emplace(participant).stored);
      memories->stored.expect_experiment(experiment->id);
    }
  }

  void on_report(const wire::ChannelReport& report) {
    Pilot* pilot = pilot_of(report);
    if (pilot == nullptr) return;
    go_on(*pilot, pilot->offer(report));
    ask_for_memory(*pilot);
  }

  void on_memory(const wire::StoredMemory& memory) {
    for (const auto& [stream, pilot] : pilots)
      if (memory.agent() == pilot->spec().name && pilot->remember(memory)) resume(*pilot);
  }

  /// Asked again with every repetition of the report that waits for it.
  void ask_for_memory(const Pilot& pilot) {
    if (pilot.thinking() || !pilot.wanted_memory()) return;
    wire::MemoryRequest request;
    request.experiment_id(wire::experiment_id(experiment->id));
    request.condition(pilot.wanted_memory()->condition);
    request.trial(pilot.wanted_memory()->trial);
    request.agent(wire::name(pilot.spec().name));
    memories->requests.write(request);
  }

  void on_profile(const wire::HeightProfile& profile) {
    const auto at = pilots.find(profile.stream());
    if (at == pilots.end()) {
      early_profiles(profile);
      return;
    }
    at->second->foresee(profile);
    resume(*at->second);
  }

  /// Profiles may overtake the first report of a stream.
  void early_profiles(const wire::HeightProfile& profile) {
    constexpr std::size_t max_early = 8192;
    if (early.size() == max_early) early.clear();  // the channel sends again what is missed
    early.push_back(profile);
  }

  Pilot* pilot_of(const wire::ChannelReport& report) {
    const auto at = pilots.find(report.stream());
    if (at != pilots.end() && report.agent() == at->second->spec().name) return at->second.get();
    const auto spec = std::find_if(served.begin(), served.end(),
                                   [&](const agents::AgentSpec* one) { return report.agent() == one->name; });
    if (spec == served.end() || (at != pilots.end() && at->second->thinking())) return nullptr;
    auto& pilot = pilots[report.stream()];
    pilot = std::make_unique<Pilot>(**spec, report.stream());
    std::erase_if(early, [&](const wire::HeightProfile& profile) {
      if (profile.stream() != report.stream()) return false;
      pilot->foresee(profile);
      return true;
    });
    return pilot.get();
  }

  void resume(Pilot& pilot) {
    while (!pilot.thinking()) {
      const Verdict verdict = pilot.resume();
      if (verdict == Verdict::nothing) return ask_for_memory(pilot);
      go_on(pilot, verdict);
    }
  }

  void go_on(Pilot& pilot, Verdict verdict) {
    if (verdict != Verdict::think) return send(pilot, verdict);
    if (!pool) {
      pilot.task().run();
      finish(pilot);
      return;
    }
    pool->submit([this, &pilot] {
      pilot.task().run();
      {
        const std::lock_guard lock(finished_mutex);
        finished.push_back(&pilot);
      }
      waiter.wake();
    });
  }

  void send(Pilot& pilot, Verdict verdict) {
    if (verdict == Verdict::answer) commands.write(pilot.answer());
    if (verdict == Verdict::hand_over) memories->handed_over.write(pilot.memory());
  }

  /// Height commands are written here and nowhere else: by the loop.
  void finish_thoughts() {
    std::vector<Pilot*> done;
    {
      const std::lock_guard lock(finished_mutex);
      done.swap(finished);
    }
    for (Pilot* pilot : done) finish(*pilot);
  }

  void finish(Pilot& pilot) {
    if (!pilot.task().error.empty())
      spdlog::error("agent {}: {}; asks for the flight to start again", pilot.spec().name, pilot.task().error);
    send(pilot, pilot.finish());
    resume(pilot);
  }

  void publish_status(wire::AgentState idle_state) {
    for (const agents::AgentSpec* spec : served) {
      const agents::AgentType& type = agents::agent_type(spec->type);
      wire::AgentStatus status;
      status.agent(wire::name(spec->name));
      status.process(wire::name(participant.options().process));
      status.experiment_id(wire::experiment_id(experiment->id));
      status.type(wire::name(spec->type));
      status.privilege(bus::to_wire(type.privilege));
      status.pid(static_cast<std::uint32_t>(getpid()));
      status.state(idle_state);
      for (const auto& [stream, pilot] : pilots) {
        if (&pilot->spec() != spec) continue;
        status.flights(status.flights() + pilot->flights());
        if (idle_state == wire::AGENT_READY && pilot->flying()) status.state(wire::AGENT_FLYING);
      }
      statuses.write(status);
    }
  }

  AgentHostOptions options;
  bus::StopSignal& stop;
  bus::Participant participant;
  bus::Writer<wire::HeightCommand> commands;
  bus::Writer<wire::AgentStatus> statuses{participant};
  runtime::RunFollower follower{participant};
  bus::Reader<wire::ChannelReport> reports{participant};
  std::optional<bus::Reader<wire::HeightProfile>> profiles;
  std::optional<Memories> memories;
  bus::Waiter waiter{stop};
  LivelinessTimer liveliness{commands};

  std::shared_ptr<const experiment::Experiment> experiment;
  std::vector<const agents::AgentSpec*> served;
  std::map<std::uint32_t, std::unique_ptr<Pilot>> pilots;  // by stream
  std::vector<wire::HeightProfile> early;

  std::mutex finished_mutex;
  std::vector<Pilot*> finished;
  std::optional<ThreadPool> pool;  // last: its threads use what stands above
};

AgentHost::AgentHost(const bus::BusOptions& place, const AgentHostOptions& options, bus::StopSignal& stop)
    : state_(std::make_unique<State>(place, options, stop)) {}

AgentHost::~AgentHost() = default;

void AgentHost::run() {
  state_->run();
}

}  // namespace aloft::agent_host
