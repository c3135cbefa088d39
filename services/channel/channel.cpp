#include "services/channel/channel.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/seconds.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/store/result_store.hpp"
#include "services/channel/agent_directory.hpp"
#include "services/channel/episode.hpp"
#include "services/channel/map_builder.hpp"
#include "services/channel/missing_peers.hpp"
#include "services/channel/outbox.hpp"
#include "services/channel/own_status.hpp"
#include "services/channel/relay/swap_desk.hpp"
#include "services/channel/trials.hpp"
#include "services/runtime/run_follower.hpp"

namespace aloft::channel {
namespace {

constexpr std::chrono::milliseconds tick_period{50};
constexpr std::chrono::milliseconds status_period{500};
constexpr std::chrono::seconds answer_limit{60};
constexpr std::chrono::milliseconds farewell_time{500};
constexpr std::size_t max_waiting_for_storage = 32;

/// Attempts must differ from those of a channel that this one replaces: they count from the time of day.
std::uint32_t first_attempt() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

struct Channel {
  Channel(const bus::BusOptions& place, const ChannelOptions& options, StopSignal& stop_signal)
      : stop(stop_signal),
        participant(place),
        waiter(stop_signal),
        trials(options.lanes),
        own(place.worker, options.agents) {
    waiter.add(follower.reader());
    waiter.add(worlds);
    waiter.add(commands);
    waiter.add(memories);
    waiter.add(followed);
    waiter.add(swap_requests);
    waiter.add(agent_statuses);
    waiter.add(stored);
    waiter.add(refused);
  }

  // --- the loop ---

  void run() {
    auto next_tick = Clock::now();
    while (!stop.requested() && !follower.over()) {
      waiter.wait(time_to_wait());
      now = Clock::now();
      if (follower.update()) begin();
      if (!experiment) continue;
      if (std::exchange(collector, follower.collector()) != follower.collector()) outbox.start_over();
      commands.drain([this](const wire::HeightCommand& command) { on_command(command); });
      followed.drain([this](const wire::ReportFollowed& message) { on_followed(message); });
      memories.drain([this](const wire::FlightMemory& memory) { on_memory(memory); });
      swap_requests.drain([this](const wire::SwapRequest& request) { on_swap(request); });
      stored.drain([this](const wire::EpisodeStored& message) { on_stored(message); });
      refused.drain([this](const wire::RecordRefused& message) { on_refused(message); });
      worlds.drain([this](const wire::World& world) { on_world(world); });
      agent_statuses.drain([this](const wire::AgentStatus& status) { on_agent(status); });
      for (MapBuilder::Built& built : builder.take()) on_map(built);
      start_flights();
      if (now >= next_tick) {
        tick();
        next_tick = now + tick_period;
      }
      give_up();
      if (changed || now >= next_status) publish_status(capacity());
    }
    if (experiment) leave();
  }

  /// With nothing in the air or to be stored, only the next status is due.
  [[nodiscard]] std::chrono::milliseconds time_to_wait() const {
    if (!experiment) return status_period;
    if (!trials.all().empty() || outbox.size() > 0) return tick_period;
    return std::clamp(std::chrono::ceil<std::chrono::milliseconds>(next_status - Clock::now()),
                      std::chrono::milliseconds(0), status_period);
  }

  /// Reports that this worker leaves, so that its trials go to others at once, and lets its last records arrive.
  void leave() {
    publish_status(0);
    statuses.wait_acknowledged(farewell_time);
    records.wait_acknowledged(farewell_time);
  }

  void tick() {
    for (const auto& [process, names] : agents.expire(now)) {
      spdlog::warn("{} is silent; flights wait for {}", process, agents_text(names));
      changed = true;
    }
    for (std::unique_ptr<Episode>& episode : episodes) {
      if (!episode) continue;
      const Clock::duration silence = episode->silence(now);
      if (silence > answer_limit)
        fail(episode->address().lease_id,
             fmt::format("agent {} did not answer for {} s", episode->awaited(), answer_limit.count()));
      else if (const auto outcome = episode->wait_no_longer(now); outcome != Episode::Outcome::ignored)
        go_on(*episode, outcome, seconds(silence));
      else if (episode->repeat_due(now))
        ask(*episode);
    }
    if (swaps.recount(episodes)) swap_replies.write(swaps.reply());
    outbox.send_due(now, [this](wire::EpisodeRecord& record) { records.write(record); });
    look_for_missing();
  }

  // --- what arrives ---

  void begin() {
    experiment = follower.experiment();
    own.begin(experiment->id);
    episodes.resize(experiment->agents.size() * trials.lanes());
    worlds.expect_experiment(experiment->id);
    agent_statuses.expect_experiment(experiment->id);
    stored.expect_experiment(experiment->id);
    refused.expect_experiment(experiment->id);
    changed = true;
  }

  void on_world(const wire::World& world) {
    if (world.kind() == wire::WORLD_CANCELLED) return cancel(world.lease_id());
    if (trials.knows(world.lease_id()) || trials.all().size() >= limits::leases) return;
    if (world.kind() == wire::WORLD_FAILED) {
      trials.add(world.lease_id(), world.condition(), world.trial(), {});
      return fail(world.lease_id(), std::string(wire::view(world.error())));
    }
    trials.add(world.lease_id(), world.condition(), world.trial(), wire::texts(world.agents()));
    changed = true;
    if (world.condition() >= experiment->conditions.size() || world.trial() >= experiment->trials)
      return fail(world.lease_id(),
                  fmt::format("the experiment has no trial {} of condition {}", world.trial(), world.condition()));
    for (const wire::AgentName& agent : world.agents())
      if (experiment->agent_index(wire::view(agent.text())) == experiment->agents.size())
        return fail(world.lease_id(), fmt::format("the experiment has no agent {}", wire::view(agent.text())));
    builder.submit(experiment, world);
  }

  void on_map(MapBuilder::Built& built) {
    Trial* trial = trials.find(built.lease_id);
    if (trial == nullptr) return;  // cancelled meanwhile
    if (!built.map) return fail(built.lease_id, built.error);
    trial->map = std::move(built.map);
  }

  void on_agent(const wire::AgentStatus& status) {
    if (!agents.update(status, now)) return;
    spared.erase(status.agent().to_string());
    for (const std::unique_ptr<Episode>& episode : episodes)
      if (episode) episode->comes(wire::view(status.agent()));
    spdlog::info("agent {} is there (process {} {})", wire::view(status.agent()), wire::view(status.process()),
                 status.pid());
    changed = true;
  }

  void on_command(const wire::HeightCommand& command) {
    Episode* const found = find(command.stream());
    if (found == nullptr) return;
    Episode& episode = *found;
    const auto heard = Clock::now();
    const double answer_s = seconds(episode.silence(heard));
    const agents::AgentSpec& asked = episode.pilot();
    const Episode::Outcome outcome = episode.accept(command, heard);
    if (command.agent() != asked.name &&
        (outcome != Episode::Outcome::ignored || command.agent() == episode.pilot().name))
      spdlog::warn("agent {} is lost in condition {}, trial {}; {} takes over at step {}", asked.name,
                   episode.address().condition, episode.address().trial, wire::view(command.agent()), command.step());
    go_on(episode, outcome, answer_s);
  }

  void on_followed(const wire::ReportFollowed& message) {
    Episode* const found = find(message.stream());
    if (found == nullptr) return;
    Episode& episode = *found;
    const double answer_s = seconds(episode.silence(now));
    go_on(episode, episode.accept(message, now), answer_s);
  }

  /// `answer_s`: time from the report to the command that answers it.
  void go_on(Episode& episode, Episode::Outcome outcome, double answer_s) {
    switch (outcome) {
      case Episode::Outcome::ignored:
        return;
      case Episode::Outcome::stepped:
        own.count_step(answer_s);
        return ask(episode);
      case Episode::Outcome::finished:
        own.count_step(answer_s);
        ask(episode);
        return land(episode);
      case Episode::Outcome::lost:
        return start_again(episode);
      case Episode::Outcome::passed_on:
        spdlog::warn("agent {} flies on in condition {}, trial {}, because another one could not", episode.pilot().name,
                     episode.address().condition, episode.address().trial);
        return ask(episode);
      case Episode::Outcome::forbidden:
        return fail(episode.address().lease_id, fmt::format("agent {} may not jump to a height", episode.pilot().name));
    }
  }

  void on_swap(const wire::SwapRequest& request) {
    const bool repeated = request.request_id() == swaps.reply().request_id();
    for (Episode* episode : swaps.handle(request, *experiment, agents, episodes, now)) ask(*episode);
    swap_replies.write(swaps.reply());
    if (!repeated && swaps.reply().accepted())
      spdlog::info("agent {} flies from step {} on, as asked", wire::view(request.agent()), request.from_step());
    else if (!repeated)
      spdlog::warn("refuses a swap: {}", wire::view(swaps.reply().message()));
  }

  void on_memory(const wire::FlightMemory& memory) {
    Episode* const episode = find(memory.stream());
    if (episode != nullptr && episode->accept(memory) == Episode::Outcome::finished) land(*episode);
  }

  /// Flights that another collector has stored are not among the run's results.
  void on_stored(const wire::EpisodeStored& message) {
    if (message.collector() != collector) return;
    const auto lease = outbox.settle(message.episode_id(), wire::view(message.digest()), now);
    if (!lease) return;  // of another worker, or not this trace
    Trial* trial = trials.find(*lease);
    if (trial == nullptr) return;
    trial->unconfirmed.erase(message.episode_id());
    forget_if_done(*trial);
  }

  /// The collector will never store this record, which would be sent without end: its trial fails instead.
  void on_refused(const wire::RecordRefused& message) {
    if (message.collector() != collector) return;
    const auto lease = outbox.settle(message.episode_id(), wire::view(message.digest()), now);
    if (!lease) return;  // not this trace
    if (trials.find(*lease) != nullptr)
      fail(*lease, fmt::format("a flight cannot be stored: {}", wire::view(message.reason())));
  }

  // --- flights ---

  void start_flights() {
    for (Trial& trial : trials.all()) {
      if (!trial.map || trial.waiting.empty()) continue;
      if (trial.lane < 0 && !trials.take_lane(trial)) continue;
      std::erase_if(trial.waiting, [&](const std::string& name) {
        const agents::AgentSpec& spec = experiment->agents[experiment->agent_index(name)];
        const std::vector<std::string> missing_agents = agents.absent(spec);
        if (!missing_agents.empty() && !can_spare(spec, missing_agents)) return false;
        start(trial, spec, missing_agents);
        return true;
      });
    }
  }

  /// `without`: the members of its crew that are not there.
  void start(Trial& trial, const agents::AgentSpec& spec, const std::vector<std::string>& without) {
    const auto index = static_cast<std::size_t>(&spec - experiment->agents.data());
    agents::Privilege privilege = agents::Privilege::none;
    try {
      const bool foreign = agents::agent_type(spec.type).foreign;
      privilege = granted(spec, foreign ? agents.find(spec.name)->privilege : wire::PRIVILEGE_NONE);
    } catch (const InputError& error) {
      return fail(trial.lease_id, error.what());
    }
    EpisodeAddress address;
    address.lease_id = trial.lease_id;
    address.experiment_id = experiment->id;
    address.episode_id = experiment::episode_id(*experiment, {trial.condition, trial.trial, spec.name});
    address.attempt = ++last_attempt;
    address.stream = static_cast<std::uint32_t>(index) * trials.lanes() + static_cast<std::uint32_t>(trial.lane);
    address.condition = trial.condition;
    address.trial = trial.trial;
    auto& episode = episodes[address.stream];
    episode = std::make_unique<Episode>(address, spec, privilege, *trial.map, experiment->seed,
                                        experiment->costs_in(experiment->conditions.at(trial.condition)), now,
                                        experiment->on_agent_loss == experiment::OnAgentLoss::failover);
    for (const std::string& name : without)
      if (spared.insert(name).second) spdlog::warn("agent {} is not there; relays fly without it until it comes", name);
    episode->do_without(without, now);
    swaps.brief(*episode, now);
    ++trial.in_the_air;
    ask(*episode);
  }

  void ask(Episode& episode) {
    try {
      episode.ask(senders, now);
    } catch (const std::exception& error) {
      fail(episode.address().lease_id, fmt::format("agent {}: {}", episode.pilot().name, error.what()));
    }
  }

  void start_again(Episode& episode) {
    const std::uint64_t lease = episode.address().lease_id;
    const std::string name = episode.agent().name;
    const std::uint32_t restarts = ++lost_histories[episode.address().episode_id];
    if (restarts >= experiment->max_attempts)
      return fail(lease, fmt::format("agent {} lost the history of its flight {} times; see its log", name, restarts));
    spdlog::warn("agent {} has no history of its flight of condition {}, trial {}; it starts again", name,
                 episode.address().condition, episode.address().trial);
    episodes[episode.address().stream].reset();
    Trial* trial = trials.find(lease);
    --trial->in_the_air;
    trial->waiting.push_back(name);
  }

  void land(const Episode& episode) {
    Trial& trial = *trials.find(episode.address().lease_id);
    const EpisodeAddress& address = episode.address();
    wire::EpisodeRecord record;
    record.experiment_id(wire::experiment_id(experiment->id));
    record.episode_id(address.episode_id);
    record.condition(address.condition);
    record.trial(address.trial);
    record.agent(wire::name(episode.agent().name));
    record.worker(wire::name(participant.options().worker));
    record.lease_id(trial.lease_id);
    record.trace(wire::bytes(store::encode_trace(episode.flight().record())));
    record.agent_memory(episode.agent_memory());
    outbox.add(std::move(record), now);
    outbox.send_due(now, [this](wire::EpisodeRecord& due) { records.write(due); });
    lost_histories.erase(address.episode_id);
    trial.unconfirmed.insert(address.episode_id);
    --trial.in_the_air;
    own.count_flight();
    episodes[address.stream].reset();
    if (!trial.flown()) return;
    trials.give_back(trial);
    changed = true;
  }

  void forget_if_done(Trial& trial) {
    if (!trial.flown() || !trial.unconfirmed.empty()) return;
    trials.remove(trial.lease_id);
    changed = true;
  }

  void cancel(std::uint64_t lease) {
    if (trials.find(lease) == nullptr) return;
    for (std::unique_ptr<Episode>& episode : episodes)
      if (episode && episode->address().lease_id == lease) episode.reset();
    trials.remove(lease);
    changed = true;
  }

  /// Notes that a lease cannot be finished; the coordinator decides what happens to its trial.
  void fail(std::uint64_t lease, const std::string& reason) { failing.try_emplace(lease, reason); }

  /// Gives up the failed leases. Not in fail(), whose callers still use their flights.
  void give_up() {
    for (const auto& [lease, reason] : failing) {
      spdlog::error("lease {}: {}", lease, reason);
      cancel(lease);
      own.add_failure(lease, reason);
    }
    failing.clear();
  }

  // --- status ---

  [[nodiscard]] std::uint32_t capacity() const {
    // One trial more than can fly, so that its world and map are ready in time; and trials that only wait for the
    // collector do not count.
    return trials.lanes() + 1 +
           static_cast<std::uint32_t>(std::min(trials.waiting_for_storage(), max_waiting_for_storage));
  }

  void publish_status(std::uint32_t capacity_wanted) {
    wire::WorkerStatus status = own.next();
    status.capacity(capacity_wanted);
    for (const Trial& trial : trials.all()) status.leases().push_back(trial.lease_id);
    status.agents(agents.news(now));
    status.records_unconfirmed(static_cast<std::uint32_t>(outbox.size()));
    status.drops(participant.drops() + bus::total(participant.refused()));
    status.missing(wire::message(missing.text()));
    statuses.write(status);
    changed = false;
    next_status = now + status_period;
  }

  void look_for_missing() {
    MissingPeers::Facts facts;
    for (const std::unique_ptr<Episode>& episode : episodes)
      if (episode && episode->silence(now) > MissingPeers::patience) {
        Clock::duration& longest = facts.silent_agents[episode->awaited()];
        longest = std::max(longest, episode->silence(now));
      }
    facts.absent_agents = note_absent_agents();
    facts.collector_silence = outbox.silence(now);
    facts.records_unconfirmed = outbox.size();
    facts.environment_there = worlds.matched() > 0;
    missing.update(facts, now);
  }

  /// Notes which agents trials wait for, and returns those that they have waited long enough for.
  [[nodiscard]] std::vector<std::string> note_absent_agents() {
    std::vector<std::string> names;
    for (const Trial& trial : trials.all())
      if (trial.lane >= 0)
        for (const std::string& waiting : trial.waiting)
          for (const std::string& name : agents.absent(experiment->agents[experiment->agent_index(waiting)]))
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    for (const std::string& name : names) agents.miss(name, now);
    std::erase_if(names, [&](const std::string& name) { return !agents.waited_long(name, now); });
    return names;
  }

  /// Whether a relay has waited long enough for these members of its crew, and can fly with the others.
  [[nodiscard]] bool can_spare(const agents::AgentSpec& spec, const std::vector<std::string>& names) const {
    return experiment->on_agent_loss == experiment::OnAgentLoss::failover && names.size() < spec.crew.size() &&
           std::ranges::all_of(names, [&](const std::string& name) { return agents.waited_long(name, now); });
  }

  /// Null if there is no flight in this stream.
  [[nodiscard]] Episode* find(std::uint32_t stream) const {
    return stream < episodes.size() ? episodes[stream].get() : nullptr;
  }

  StopSignal& stop;
  bus::Participant participant;
  runtime::RunFollower follower{participant};
  bus::Reader<wire::World> worlds{participant};
  bus::Reader<wire::HeightCommand> commands{participant};
  bus::Reader<wire::ReportFollowed> followed{participant};
  bus::Reader<wire::FlightMemory> memories{participant};
  bus::Reader<wire::SwapRequest> swap_requests{participant};
  bus::Reader<wire::AgentStatus> agent_statuses{participant};
  bus::Reader<wire::EpisodeStored> stored{participant};
  bus::Reader<wire::RecordRefused> refused{participant};
  bus::Writer<wire::ChannelReport> reports{participant};
  bus::Writer<wire::SiteMap> site_maps{participant};
  bus::Writer<wire::HeightProfile> profiles{participant};
  bus::Writer<wire::SwapReply> swap_replies{participant};
  bus::Writer<wire::EpisodeRecord> records{participant};
  bus::Writer<wire::WorkerStatus> statuses{participant};
  bus::Waiter waiter;
  const Episode::Senders senders{[this](wire::SiteMap& map) { site_maps.write(map); },
                                 [this](wire::HeightProfile& profile) { profiles.write(profile); },
                                 [this](wire::ChannelReport& report) { reports.write(report); }};

  std::shared_ptr<const experiment::Experiment> experiment;
  Trials trials;
  std::vector<std::unique_ptr<Episode>> episodes;  // by stream
  std::map<std::uint64_t, std::uint32_t> lost_histories;
  AgentDirectory agents;
  std::set<std::string> spared;  // agents that relays fly without
  std::uint64_t collector = 0;   // incarnation whose confirmations count; 0: not known yet
  Outbox outbox;
  SwapDesk swaps;

  Clock::time_point now;
  bool changed = false;
  Clock::time_point next_status;
  std::uint32_t last_attempt = first_attempt();
  std::map<std::uint64_t, std::string> failing;  // leases, with the reason
  OwnStatus own;
  MissingPeers missing{Clock::now()};

  MapBuilder builder{[this] { waiter.wake(); }};  // last: its thread uses the members above
};

}  // namespace

void fly(const bus::BusOptions& place, const ChannelOptions& options, StopSignal& stop) {
  Channel(place, options, stop).run();
}

}  // namespace aloft::channel
