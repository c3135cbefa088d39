#include "services/agent_host/agent_host.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>

#include "common/bus/convert.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/warnings.hpp"
#include "services/agent_host/liveliness_timer.hpp"
#include "services/agent_host/pilot.hpp"
#include "services/agent_host/relay_seat.hpp"
#include "services/runtime/run_follower.hpp"

namespace aloft::agent_host {
namespace {

using Clock = std::chrono::steady_clock;
using Verdict = Pilot::Verdict;

constexpr std::chrono::milliseconds status_period{500};

/// For agents that remember earlier flights.
struct Memories {
  explicit Memories(const bus::Participant& participant)
      : requests(participant), stored(participant), handed_over(participant) {}
  bus::Writer<wire::MemoryRequest> requests;
  bus::Reader<wire::StoredMemory> stored;
  bus::Writer<wire::FlightMemory> handed_over;
};

/// An agent that this process hosts, and whose flights it takes part in.
struct Role {
  const agents::AgentSpec* entry;              ///< in the experiment
  const agents::AgentSpec* agent;              ///< the entry itself, or a member of its crew
  const agents::CrewMember* member = nullptr;  ///< set if the entry is a relay
};

/// One agent at one stream.
struct Seat {
  const agents::AgentSpec* entry;
  std::unique_ptr<RelaySeat> crew;  ///< null if the entry is no relay
  Pilot pilot;
};

struct AgentHost {
  AgentHost(const bus::BusOptions& place, const AgentHostOptions& wanted, StopSignal& stop_signal)
      : options(wanted), stop(stop_signal), participant(place), commands(participant, {.strength = wanted.strength}) {
    liveliness.add(commands);
    waiter.add(follower.reader());
    waiter.add(reports);
  }

  void run() {
    auto next_status = Clock::now();
    while (!stop.requested() && !follower.over()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_status - Clock::now());
      waiter.wait(std::max(left, std::chrono::milliseconds(0)));
      if (follower.update()) begin();
      if (site_maps) site_maps->drain([this](const wire::SiteMap& map) { on_site_map(map); });
      if (profiles) profiles->drain([this](const wire::HeightProfile& profile) { on_profile(profile); });
      if (memories) memories->stored.drain([this](const wire::StoredMemory& memory) { on_memory(memory); });
      reports.drain([this](const wire::ChannelReport& report) { on_report(report); });
      finish_thoughts();
      if (Clock::now() < next_status) continue;
      publish_status(wire::AGENT_READY);
      next_status = Clock::now() + status_period;
    }
    pool.reset();  // drops tasks that have not begun, waits for the others
    publish_status(wire::AGENT_STOPPED);
  }

  void begin() {
    experiment = follower.experiment();
    reports.expect_experiment(experiment->id);
    for (const agents::AgentSpec& spec : experiment->agents) {
      if (spec.crew.empty()) serve({&spec, &spec});
      for (const agents::CrewMember& member : spec.crew) serve({&spec, &member.agent, &member});
    }
    for (const experiment::Warning& warning : experiment::warnings(*experiment))
      if (std::ranges::any_of(roles, [&](const Role& role) { return role.agent->name == warning.agent; }))
        spdlog::warn(warning.text);
    publish_status(wire::AGENT_READY);
  }

  void serve(const Role& role) {
    const agents::AgentSpec& spec = *role.agent;
    const agents::AgentType& type = agents::agent_type(spec.type);
    if (type.foreign || type.hosted_by() != options.host) return;
    if (!options.agents.empty() && std::ranges::find(options.agents, spec.name) == options.agents.end()) return;
    roles.push_back(role);
    spdlog::info("serves agent {}{}", spec.name, role.member == nullptr ? "" : " in the crew of " + role.entry->name);
    if (role.member != nullptr && !followed) followed.emplace(participant);
    // Only a process that serves an agent of this tier joins the partition of the site maps, or that of the height
    // profiles, which show the future.
    if (computes(spec) && !pool) pool.emplace(options.threads);
    if (type.privilege == agents::Privilege::site_map && !site_maps) waiter.add(site_maps.emplace(participant));
    if (agents::foresees(type.privilege) && !profiles) {
      profiles.emplace(participant);
      waiter.add(*profiles);
    }
    if (spec.lineages() > 0) {
      if (!memories) waiter.add(memories.emplace(participant).stored);
      memories->stored.expect_experiment(experiment->id);
    }
  }

  void on_report(const wire::ChannelReport& report) {
    for (const std::unique_ptr<Seat>& seat : take_seats(report)) {
      if (seat->crew && !seat->crew->hear(report, seat->pilot)) continue;
      go_on(*seat, seat->pilot.offer(report));
      ask_for_memory(seat->pilot);
    }
  }

  void on_memory(const wire::StoredMemory& memory) {
    for (const auto& [stream, at_stream] : seats)
      for (const std::unique_ptr<Seat>& seat : at_stream)
        if (memory.agent() == seat->pilot.spec().name && seat->pilot.remember(memory)) resume(*seat);
  }

  /// The request is repeated with every repetition of the report that waits for the memory.
  void ask_for_memory(const Pilot& pilot) {
    if (pilot.thinking() || !pilot.wanted_memory()) return;
    wire::MemoryRequest request;
    request.experiment_id(wire::experiment_id(experiment->id));
    request.condition(pilot.wanted_memory()->condition);
    request.trial(pilot.wanted_memory()->trial);
    request.agent(wire::name(pilot.spec().name));
    memories->requests.write(request);
  }

  void on_site_map(const wire::SiteMap& map) {
    const auto at = seats.find(map.stream());
    if (at == seats.end()) return early_map(map);
    for (const std::unique_ptr<Seat>& seat : at->second) survey(*seat, map);
  }

  void survey(Seat& seat, const wire::SiteMap& map) {
    if (agents::agent_type(seat.pilot.spec().type).privilege != agents::Privilege::site_map) return;
    try {
      seat.pilot.survey(map);
    } catch (const std::exception& error) {
      spdlog::warn("agent {}: dropped a site map: {}", seat.pilot.spec().name, error.what());
    }
    resume(seat);
  }

  /// Maps can arrive before the first report of a stream.
  void early_map(const wire::SiteMap& map) {
    constexpr std::size_t max_early = 64;  // the channel repeats the map with its report
    if (early_maps.size() < max_early || early_maps.contains(map.stream())) early_maps[map.stream()] = map;
  }

  void on_profile(const wire::HeightProfile& profile) {
    const auto at = seats.find(profile.stream());
    if (at == seats.end()) {
      early_profiles(profile);
      return;
    }
    for (const std::unique_ptr<Seat>& seat : at->second) {
      seat->pilot.foresee(profile);
      resume(*seat);
    }
  }

  /// Profiles can arrive before the first report of a stream.
  void early_profiles(const wire::HeightProfile& profile) {
    constexpr std::size_t max_early = 8192;
    if (early.size() == max_early) early.clear();  // the channel repeats profiles with its report
    early.push_back(profile);
  }

  using Seats = std::vector<std::unique_ptr<Seat>>;

  /// The seats of our agents that the report can concern; made when the stream begins a flight of another entry.
  const Seats& take_seats(const wire::ChannelReport& report) {
    static const Seats nobody;
    const auto& flown_by = report.relay() == "" ? report.agent() : report.relay();
    const auto at = seats.find(report.stream());
    if (at != seats.end() && flown_by == at->second.front()->entry->name) return at->second;
    Seats taken;
    for (const Role& role : roles)
      if (flown_by == role.entry->name) taken.push_back(seat(role, report.stream()));
    if (taken.empty() ||
        (at != seats.end() && std::ranges::any_of(at->second, [](const auto& seat) { return seat->pilot.thinking(); })))
      return nobody;
    std::erase_if(early, [&](const wire::HeightProfile& profile) {
      if (profile.stream() != report.stream()) return false;
      for (const std::unique_ptr<Seat>& seat : taken) seat->pilot.foresee(profile);
      return true;
    });
    if (const auto map = early_maps.extract(report.stream()))
      for (const std::unique_ptr<Seat>& seat : taken) survey(*seat, map.mapped());
    return seats[report.stream()] = std::move(taken);
  }

  std::unique_ptr<Seat> seat(const Role& role, std::uint32_t stream) {
    if (role.member == nullptr) return std::make_unique<Seat>(Seat{role.entry, nullptr, Pilot(*role.agent, stream)});
    const bool stands_by = experiment->on_agent_loss == experiment::OnAgentLoss::failover;
    auto crew = std::make_unique<RelaySeat>(participant, liveliness, *role.entry, *role.member, stands_by);
    const Boarding boarding = crew->boarding();
    return std::make_unique<Seat>(Seat{role.entry, std::move(crew), Pilot(*role.agent, stream, boarding)});
  }

  void resume(Seat& seat) {
    while (!seat.pilot.thinking()) {
      const Verdict verdict = seat.pilot.resume();
      if (verdict == Verdict::nothing) return ask_for_memory(seat.pilot);
      go_on(seat, verdict);
    }
  }

  /// Whether the agent can compute for long: not in the loop, which must answer for the others and say that the process
  /// is there. Learners do, and who surveys: a wrong map is drawn many times.
  [[nodiscard]] bool computes(const agents::AgentSpec& agent) const {
    return options.host == agents::Host::learning_agent ||
           agents::agent_type(agent.type).privilege == agents::Privilege::site_map;
  }

  void go_on(Seat& seat, Verdict verdict) {
    if (verdict != Verdict::think) return send(seat, verdict);
    if (!computes(seat.pilot.spec())) {
      seat.pilot.task().run();
      finish(seat);
      return;
    }
    boost::asio::post(*pool, [this, &seat] {
      seat.pilot.task().run();
      {
        const std::lock_guard lock(finished_mutex);
        finished.push_back(&seat);
      }
      waiter.wake();
    });
  }

  void send(Seat& seat, Verdict verdict) {
    if (verdict == Verdict::answer && seat.crew)
      answer(*seat.crew, seat.pilot.answer());
    else if (verdict == Verdict::answer)
      commands.write(seat.pilot.answer());
    if (verdict == Verdict::hand_over) memories->handed_over.write(seat.pilot.memory());
  }

  /// A member of a crew commands if it is asked or takes over; if it is not asked, it reports that it has followed.
  void answer(RelaySeat& crew, wire::HeightCommand& command) {
    const bool unknown = command.action() == wire::ACTION_UNKNOWN_FLIGHT;
    if (crew.asked() || (crew.commands() && !unknown)) crew.command(command);
    if (crew.asked()) return;
    wire::ReportFollowed message;
    message.stream(command.stream());
    message.episode_id(command.episode_id());
    message.attempt(command.attempt());
    message.step(command.step() - 1);
    message.agent(command.agent());
    message.unknown_flight(unknown);
    followed->write(message);
  }

  /// Only this loop writes height commands; the threads of the pool never do.
  void finish_thoughts() {
    std::vector<Seat*> done;
    {
      const std::lock_guard lock(finished_mutex);
      done.swap(finished);
    }
    for (Seat* seat : done) finish(*seat);
  }

  void finish(Seat& seat) {
    if (!seat.pilot.task().error.empty())
      spdlog::error("agent {}: {}; asks for the flight to start again", seat.pilot.spec().name,
                    seat.pilot.task().error);
    send(seat, seat.pilot.finish());
    resume(seat);
  }

  void publish_status(wire::AgentState idle_state) {
    std::vector<std::string_view> told;
    for (const Role& role : roles) {
      if (std::ranges::find(told, role.agent->name) != told.end()) continue;
      told.push_back(role.agent->name);
      wire::AgentStatus status;
      status.agent(wire::name(role.agent->name));
      status.process(wire::name(participant.options().process));
      status.experiment_id(wire::experiment_id(experiment->id));
      status.type(wire::name(role.agent->type));
      status.privilege(bus::to_wire(agents::agent_type(role.agent->type).privilege));
      status.pid(static_cast<std::uint32_t>(getpid()));
      status.state(idle_state);
      count_flights(status);
      statuses.write(status);
    }
  }

  /// Adds up the flights of the agent; while it has some, it is not idle.
  void count_flights(wire::AgentStatus& status) {
    const bool serving = status.state() == wire::AGENT_READY;
    for (const auto& [stream, at_stream] : seats)
      for (const std::unique_ptr<Seat>& seat : at_stream) {
        if (status.agent() != seat->pilot.spec().name) continue;
        status.flights(status.flights() + seat->pilot.flights());
        if (!serving || !seat->pilot.flying() || status.state() == wire::AGENT_FLYING) continue;
        status.state(seat->crew && !seat->crew->asked() ? wire::AGENT_SHADOW : wire::AGENT_FLYING);
      }
  }

  AgentHostOptions options;
  StopSignal& stop;
  bus::Participant participant;
  bus::Writer<wire::HeightCommand> commands;
  bus::Writer<wire::AgentStatus> statuses{participant};
  runtime::RunFollower follower{participant};
  bus::Reader<wire::ChannelReport> reports{participant};
  std::optional<bus::Reader<wire::SiteMap>> site_maps;
  std::optional<bus::Reader<wire::HeightProfile>> profiles;
  std::optional<Memories> memories;
  std::optional<bus::Writer<wire::ReportFollowed>> followed;
  bus::Waiter waiter{stop};
  LivelinessTimer liveliness;

  std::shared_ptr<const experiment::Experiment> experiment;
  std::vector<Role> roles;
  std::map<std::uint32_t, Seats> seats;               // by stream
  std::map<std::uint32_t, wire::SiteMap> early_maps;  // by stream
  std::vector<wire::HeightProfile> early;

  std::mutex finished_mutex;
  std::vector<Seat*> finished;
  std::optional<boost::asio::thread_pool> pool;  // last: its threads use the members above
};

}  // namespace

void host_agents(const bus::BusOptions& place, const AgentHostOptions& options, StopSignal& stop) {
  AgentHost(place, options, stop).run();
}

}  // namespace aloft::agent_host
