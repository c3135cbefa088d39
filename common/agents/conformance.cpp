#include "common/agents/conformance.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "common/agents/steering.hpp"
#include "common/base/error.hpp"
#include "common/base/random.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/synthetic_map.hpp"

namespace aloft::agents {
namespace {

using flight::Flight;
using flight::SyntheticMap;

constexpr std::uint64_t seed = 11;
constexpr std::uint32_t trial = 5;
constexpr std::uint32_t levels = 9;

/// Who really flies: given the agent's command and the step, the command to execute.
using Pilot = std::function<Command(const Command&, std::uint32_t)>;

Command fly_as_told(const Command& command, std::uint32_t /*step*/) {
  return command;
}

/// A pilot of its own: climbs to the ceiling, stays, descends to the floor, stays.
Command fly_to_both_limits(const Command& /*command*/, std::uint32_t step) {
  const std::uint32_t phase = step % 40;
  return {phase < 12 ? Action::up : phase < 20 ? Action::hold : Action::down};
}

/// Follows the agent half of the time.
Command fly_half_as_told(const Command& command, std::uint32_t step) {
  const std::uint64_t bits = mix64(step);
  if (bits % 2 == 0) return command;
  return {bits % 4 == 1 ? Action::up : Action::down};
}

struct Told {
  Action action;
  double height_m;
  bool operator==(const Told&) const = default;
};
using Commands = std::vector<Told>;

/// An unconstrained agent flies, the one under test looks on.
Command fly_by_jumps(const Command& /*command*/, std::uint32_t step) {
  return {Action::absolute, 40.0 + 10.0 * static_cast<double>(mix64(step) % levels)};
}

class Kit {
 public:
  Kit(const AgentSpec& spec, const ConformanceOptions& options, QosKind kind)
      : spec_(spec),
        type_(agent_type(spec.type)),
        options_(options),
        map_(SyntheticMap::random(kind, options.steps, levels, seed)) {}

  void check_all() {
    check_repeatable();
    check_later_flight();
    check_limits();
    check_checkpoints();
    check_foreseeing();
    if (type_.privilege == Privilege::none) check_sees_only_reports();
    if (type_.privilege == Privilege::none) check_comes_aboard_late();
    if (type_.privilege == Privilege::next_step) check_sees_one_step_ahead();
  }

 private:
  /// One exchange: foresee, observe, act. Checks that the command is legal.
  Told exchange(const Flight& flight, Agent& agent) {
    flight::foresee(flight, type_.privilege, buffer_, [&](const HeightProfile& profile) { agent.foresee(profile); });
    agent.observe(flight.observation());
    if (flight.finished()) return {Action::none, 0.0};
    command_ = agent.act();
    const FlightInfo& info = flight.info();
    if (command_.action == Action::absolute) {
      CHECK(type_.unconstrained);
      CHECK(command_.height_m >= info.height_min_m);
      CHECK(command_.height_m <= info.height_max_m);
      return {command_.action, command_.height_m};
    }
    const bool legal =
        command_.action == Action::down || command_.action == Action::hold || command_.action == Action::up;
    CHECK(legal);
    return {command_.action, 0.0};
  }

  Commands fly(SyntheticMap& map, Agent& agent, const Pilot& pilot) {
    Flight flight(map, seed, trial);
    agent.begin(flight.info());
    Commands commands;
    while (true) {
      commands.push_back(exchange(flight, agent));
      if (flight.finished()) return commands;
      flight.step(pilot(command_, flight.observation().step), "pilot");
    }
  }

  Commands fly_fresh(SyntheticMap& map, const Pilot& pilot = fly_as_told) { return fly(map, *spec_.make(), pilot); }

  void check_repeatable() {
    INFO("the same flight gives the same commands");
    for (const auto& pilot : {fly_as_told, fly_half_as_told, fly_to_both_limits, fly_by_jumps})
      CHECK(fly_fresh(map_, pilot) == fly_fresh(map_, pilot));
  }

  void check_later_flight() {
    if (options_.lifelong) return;
    INFO("a later flight is like a fresh agent's");
    SyntheticMap larger = SyntheticMap::random(map_.qos_kind(), options_.steps + 3, levels + 2, seed + 1);
    SyntheticMap alike = SyntheticMap::random(map_.qos_kind(), options_.steps, levels, seed + 1);
    const auto agent = spec_.make();
    fly(larger, *agent, fly_half_as_told);
    fly(alike, *agent, fly_as_told);
    CHECK(fly(map_, *agent, fly_as_told) == fly_fresh(map_));
  }

  void check_limits() {
    const QosKind kind = map_.qos_kind();
    INFO("worlds of one level, and of one step");
    SyntheticMap flat = SyntheticMap::random(kind, options_.steps, 1, seed);
    fly_fresh(flat);
    SyntheticMap brief = SyntheticMap::random(kind, 1, levels, seed);
    fly_fresh(brief);
    INFO("worlds without any quality");
    SyntheticMap silent = map_;
    for (std::uint32_t point = 0; point < silent.qos().size(); ++point)
      for (std::uint32_t i = 0; i < levels; ++i) silent.set_qos(point, i, 0.0);
    fly_fresh(silent);
  }

  /// In the crew of a relay: the first report is one of mid-flight.
  void check_comes_aboard_late() {
    INFO("coming aboard in mid-flight");
    for (const std::uint32_t first : {1U, options_.steps / 2, options_.steps - 1})
      CHECK(fly_from(first) == fly_from(first));
  }

  Commands fly_from(std::uint32_t first) {
    Flight flight(map_, seed, trial);
    for (std::uint32_t step = 0; step < first; ++step) flight.step(fly_to_both_limits({}, step), "pilot");
    const auto agent = spec_.make();
    agent->begin(flight.info());
    Commands commands;
    while (true) {
      commands.push_back(exchange(flight, *agent));
      if (flight.finished()) return commands;
      flight.step(command_, "agent");
    }
  }

  void check_checkpoints() {
    const Commands whole = fly_fresh(map_, fly_half_as_told);
    for (const std::uint32_t stop : {0U, 1U, options_.steps / 2, options_.steps - 1}) {
      INFO("saved after the command of step " << stop << " and restored into a new agent");
      CHECK(fly_interrupted(stop) == whole);
    }
    const auto idle = spec_.make();
    idle->restore_state(spec_.make()->save_state());
    CHECK(fly(map_, *idle, fly_half_as_told) == whole);
  }

  Commands fly_interrupted(std::uint32_t stop) {
    Flight flight(map_, seed, trial);
    auto agent = spec_.make();
    agent->begin(flight.info());
    Commands commands;
    while (true) {
      commands.push_back(exchange(flight, *agent));
      if (flight.finished()) return commands;
      if (flight.observation().step == stop) {
        const std::string state = agent->save_state();
        CHECK(state == agent->save_state());
        check_damage_is_refused(state);
        agent = spec_.make();
        agent->restore_state(state);
        CHECK(agent->save_state() == state);
      }
      flight.step(fly_half_as_told(command_, flight.observation().step), "pilot");
    }
  }

  void check_damage_is_refused(const std::string& state) {
    const auto agent = spec_.make();
    CHECK_THROWS_AS(agent->restore_state(""), IntegrityError);
    CHECK_THROWS_AS(agent->restore_state("not a state"), IntegrityError);
    for (const std::size_t part : {1U, 2U, 3U}) {
      CHECK_THROWS_AS(agent->restore_state(state.substr(0, state.size() * part / 4)), IntegrityError);
      std::string altered = state;
      altered[state.size() * part / 4] = static_cast<char>(altered[state.size() * part / 4] ^ 1);
      CHECK_THROWS_AS(agent->restore_state(altered), IntegrityError);
    }
    CHECK_THROWS_AS(agent->restore_state(state + "x"), IntegrityError);
  }

  void check_foreseeing() {
    if (type_.privilege != Privilege::none) return;
    const auto agent = spec_.make();
    agent->begin(Flight(map_, seed, trial).info());
    CHECK_THROWS_AS(agent->foresee(HeightProfile{1, 40.0, 10.0, std::vector<double>(levels)}), std::logic_error);
  }

  /// Changes everything that the UAV did not measure; the flight must not notice.
  void check_sees_only_reports() {
    INFO("commands depend on past reports alone");
    Flight flight(map_, seed, trial);
    const auto agent = spec_.make();
    agent->begin(flight.info());
    SyntheticMap other = map_;
    for (std::uint32_t point = 0; point < other.qos().size(); ++point)
      for (std::uint32_t i = 0; i < levels; ++i) other.set_qos(point, i, 0.9 * map_.qos()[levels % 2][i] + 1.0);
    Commands commands;
    const auto keep = [&](std::uint32_t point) {
      const auto i = nearest_level(flight.info(), flight.observation().height_m);
      other.set_qos(point, i, map_.qos()[point][i]);
    };
    keep(0);
    while (true) {
      commands.push_back(exchange(flight, *agent));
      if (flight.finished()) break;
      flight.step(command_, "pilot");
      keep(map_.result_point(flight.observation().step));
    }
    CHECK(fly_fresh(other) == commands);
  }

  /// Changes everything after the middle of the flight; commands up to there must not notice.
  void check_sees_one_step_ahead() {
    INFO("commands depend on the next step at most");
    const std::uint32_t middle = options_.steps / 2;
    SyntheticMap other = map_;
    for (std::uint32_t point = map_.result_point(middle) + 1; point < other.qos().size(); ++point)
      for (std::uint32_t i = 0; i < levels; ++i) other.set_qos(point, i, map_.qos()[point][levels - 1 - i]);
    Commands ours = fly_fresh(map_);
    Commands theirs = fly_fresh(other);
    ours.resize(middle);
    theirs.resize(middle);
    CHECK(ours == theirs);
  }

  const AgentSpec& spec_;
  const AgentType& type_;
  const ConformanceOptions& options_;
  SyntheticMap map_;
  HeightProfile buffer_;
  Command command_;
};

}  // namespace

void check_conformance(const nlohmann::json& entry, const ConformanceOptions& options) {
  for (const AgentSpec& spec : parse_agents(entry, "agent")) {
    for (const QosKind kind : {QosKind::spectral_efficiency, QosKind::throughput}) {
      INFO("agent " << spec.name << ", " << (kind == QosKind::throughput ? "throughput" : "spectral efficiency"));
      Kit(spec, options, kind).check_all();
    }
  }
}

}  // namespace aloft::agents
