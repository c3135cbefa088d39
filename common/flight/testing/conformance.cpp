#include "common/flight/testing/conformance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/agents/steering.hpp"
#include "common/base/error.hpp"
#include "common/base/random.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/synthetic_map.hpp"

namespace aloft::flight {

using agents::Action;
using agents::Agent;
using agents::AgentSpec;
using agents::AgentType;
using agents::Command;
using agents::FlightInfo;
using agents::HeightProfile;
using agents::Observation;
using agents::Privilege;
using radio::QosKind;

namespace {

constexpr std::uint64_t seed = 11;
constexpr std::uint32_t trial = 5;
constexpr std::uint32_t levels = 9;
constexpr std::uint32_t to_the_end = ~0U;

/// Chooses the command to execute, given the command of the agent under test and the step.
using Pilot = std::function<Command(const Command&, std::uint32_t)>;

Command fly_as_commanded(const Command& command, std::uint32_t /*step*/) {
  return command;
}

/// Ignores the agent: climbs to the ceiling, stays, descends to the floor, stays.
Command fly_to_both_limits(const Command& /*command*/, std::uint32_t step) {
  const std::uint32_t phase = step % 40;
  return {phase < 12 ? Action::up : phase < 20 ? Action::hold : Action::down};
}

/// Executes the agent's command in half of the steps.
Command fly_half_as_commanded(const Command& command, std::uint32_t step) {
  const std::uint64_t bits = mix64(step);
  if (bits % 2 == 0) return command;
  return {bits % 4 == 1 ? Action::up : Action::down};
}

/// An unconstrained agent flies; the one under test only observes.
Command fly_by_jumps(const Command& /*command*/, std::uint32_t step) {
  return {Action::absolute, 40.0 + 10.0 * static_cast<double>(mix64(step) % levels)};
}

struct CommandSeen {
  Action action;
  double height_m;
  bool operator==(const CommandSeen&) const = default;
};
using Commands = std::vector<CommandSeen>;

std::string in_words(const CommandSeen& seen) {
  switch (seen.action) {
    case Action::none:
      return "none";
    case Action::down:
      return "down";
    case Action::hold:
      return "hold";
    case Action::up:
      return "up";
    case Action::absolute:
      return fmt::format("a jump to {} m", seen.height_m);
  }
  return fmt::format("action {}", static_cast<int>(seen.action));
}

/// The first command that differs, in words; empty if none does.
std::string difference(const Commands& now, const Commands& expected) {
  for (std::size_t i = 0; i < std::min(now.size(), expected.size()); ++i)
    if (now[i] != expected[i])
      return fmt::format("commands {} instead of {} for step {}", in_words(now[i]), in_words(expected[i]), i + 1);
  return now.size() == expected.size() ? "" : "flies another number of steps";
}

bool equal(const Observation& a, const Observation& b) {
  return a.step == b.step && a.height_m == b.height_m && a.serving_cell == b.serving_cell &&
         a.serving_sinr_db == b.serving_sinr_db && a.neighbour_count == b.neighbour_count &&
         a.neighbour_sinr_db == b.neighbour_sinr_db && a.qos == b.qos && a.executed == b.executed &&
         a.reward == b.reward && a.last == b.last;
}

/// The reports that an agent received in a flight, and its commands.
struct Flown {
  std::vector<Observation> reports;
  Commands commands;

  bool operator==(const Flown& other) const {
    return commands == other.commands &&
           std::equal(reports.begin(), reports.end(), other.reports.begin(), other.reports.end(), equal);
  }
};

/// The worlds of a check.
struct Surroundings {
  std::string_view name;
  QosKind kind = QosKind::spectral_efficiency;
  Costs costs{};
};

class Kit {
 public:
  Kit(const AgentSpec& spec, const ConformanceOptions& options, const Surroundings& around)
      : spec_(spec),
        type_(agents::agent_type(spec.type)),
        options_(options),
        around_(around),
        map_(world(around.kind, options.steps, levels, seed)) {}

  /// The first problem of every check.
  std::vector<std::string> problems() {
    check("the same flight again", [this] { return check_repeatable(); });
    if (!problems_.empty()) return problems_;  // the other checks compare flights
    check("a later flight", [this] { return check_later_flight(); });
    check_limits();
    check("saving and restoring", [this] { return check_checkpoints(); });
    check("a state from before the first flight", [this] { return check_idle_state(); });
    if (type_.privilege != Privilege::site_map)
      check("a map that it may not have", [this] { return check_surveying(); });
    if (!agents::foresees(type_.privilege)) {
      check("what may not be foreseen", [this] { return check_foreseeing(); });
      check("coming aboard in mid-flight", [this] { return check_comes_aboard_late(); });
      check("a world that is not measured", [this] {
        return depends_on_unmeasured() ? "commands depend on more than past reports: on what was never measured" : "";
      });
    }
    if (type_.privilege == Privilege::next_step)
      check("a world beyond the next step",
            [this] { return depends_beyond_next_step() ? "commands depend on more than the next step" : ""; });
    return problems_;
  }

  /// Whether the commands change when every quality that the UAV did not measure is changed.
  bool depends_on_unmeasured() {
    Flight flight(map_, seed, trial, around_.costs);
    const auto agent = spec_.make();
    SyntheticMap other = map_;
    for (std::uint32_t point = 0; point < other.qos().size(); ++point) change(other, point);
    const auto keep = [&] {
      const std::uint32_t step = flight.observation().step;
      const std::uint32_t point = step == 0 ? 0 : map_.result_point(step);
      const std::uint32_t level = agents::nearest_level(flight.info(), flight.observation().height_m);
      other.set_qos(point, level, map_.qos()[point][level]);
    };
    Flown flown;
    agent->begin(flight.info());
    while (true) {
      keep();
      exchange(flight, *agent, flown);
      if (flight.finished()) break;
      flight.step(command_, "agent");
    }
    return fly_fresh(other) != flown;
  }

  /// For every step: changes all qualities after it, and compares the commands up to it.
  bool depends_beyond_next_step() {
    const Commands ours = fly_fresh(map_).commands;
    for (std::uint32_t last = 1; last < options_.steps; ++last) {
      SyntheticMap other = map_;
      for (std::uint32_t point = map_.result_point(last) + 1; point < other.qos().size(); ++point) change(other, point);
      const Commands theirs = fly_fresh(other).commands;
      if (!std::equal(ours.begin(), ours.begin() + last, theirs.begin())) return true;
    }
    return false;
  }

 private:
  /// `run` returns the problem, or an empty text. An illegal command is reported once, whichever check found it.
  void check(std::string_view what, const std::function<std::string()>& run) {
    std::string problem;
    try {
      problem = run();
    } catch (const std::exception& error) {
      problem = fmt::format("{}: throws \"{}\"", what, error.what());
    }
    const auto name = [&](const std::string& text) {
      problems_.push_back(fmt::format("agent {}, {}: {}", spec_.name, around_.name, text));
    };
    if (!illegal_command_.empty() && !illegal_command_named_) name(illegal_command_);
    illegal_command_named_ = !illegal_command_.empty();
    if (!problem.empty()) name(problem);
  }

  static SyntheticMap world(QosKind kind, std::uint32_t steps, std::uint32_t level_count, std::uint64_t world_seed) {
    return SyntheticMap::random(kind, steps, level_count, world_seed);
  }

  /// Changes the quality at every height of a point by half of the largest, to one that is as plausible.
  static void change(SyntheticMap& map, std::uint32_t point) {
    const double half = map.qos_kind() == QosKind::throughput ? 40'000.0 : 10.0;
    for (std::uint32_t level = 0; level < levels; ++level) {
      const double old = map.qos()[point][level];
      map.set_qos(point, level, old < half ? old + half : old - half);
    }
  }

  /// One exchange: survey, foresee, observe, act. An illegal command is replaced by a legal one.
  void exchange(const Flight& flight, Agent& agent, Flown& flown) {
    if (const auto map = survey(flight, type_.privilege, flown.reports.empty())) agent.survey(*map);
    foresee(flight, type_.privilege, buffer_, [&](const HeightProfile& profile) { agent.foresee(profile); });
    agent.observe(flight.observation());
    flown.reports.push_back(flight.observation());
    if (flight.finished()) return;
    command_ = agent.act();
    flown.commands.push_back({command_.action, command_.action == Action::absolute ? command_.height_m : 0.0});
    const std::string objection = objection_to(flown.commands.back(), flight.info());
    if (objection.empty()) return;
    command_ = {};
    if (!illegal_command_.empty()) return;
    illegal_command_ =
        fmt::format("commands {} for step {}: {}", in_words(flown.commands.back()), flown.commands.size(), objection);
  }

  [[nodiscard]] std::string objection_to(const CommandSeen& seen, const FlightInfo& info) const {
    if (seen.action == Action::down || seen.action == Action::hold || seen.action == Action::up) return {};
    if (seen.action != Action::absolute) return "it is none of down, hold and up";
    if (!type_.unconstrained) return "its type is not declared unconstrained";
    if (seen.height_m >= info.height_min_m && seen.height_m <= info.height_max_m) return {};
    return fmt::format("the limits are {} to {} m", info.height_min_m, info.height_max_m);
  }

  /// Ends the flight early, after the command for step `stop` + 1.
  Flown fly(SyntheticMap& map, Agent& agent, const Pilot& pilot, std::uint64_t flight_seed = seed,
            std::uint32_t stop = to_the_end) {
    Flight flight(map, flight_seed, trial, around_.costs);
    Flown flown;
    agent.begin(flight.info());
    while (true) {
      exchange(flight, agent, flown);
      if (flight.finished() || flight.observation().step == stop) return flown;
      flight.step(pilot(command_, flight.observation().step), "pilot");
    }
  }

  Flown fly_fresh(SyntheticMap& map, const Pilot& pilot = fly_as_commanded) { return fly(map, *spec_.make(), pilot); }

  std::string check_repeatable() {
    for (const auto& pilot : {fly_as_commanded, fly_half_as_commanded, fly_to_both_limits, fly_by_jumps}) {
      const Commands first = fly_fresh(map_, pilot).commands;
      const std::string off = difference(fly_fresh(map_, pilot).commands, first);
      if (!off.empty())
        return fmt::format(
            "the same flight again {}: an agent must be a pure function of the calls to it, without a clock, global "
            "state or other randomness than that of its flight's seed and trial",
            off);
    }
    return {};
  }

  /// An agent's earlier flight, which can have ended early.
  struct Earlier {
    const char* what;
    SyntheticMap map;
    std::uint64_t flight_seed = seed + 1;
    std::uint32_t stop = to_the_end;
  };

  [[nodiscard]] std::vector<Earlier> earlier_flights() const {
    const QosKind kind = map_.qos_kind();
    const QosKind other = kind == QosKind::throughput ? QosKind::spectral_efficiency : QosKind::throughput;
    const SyntheticMap alike = world(kind, options_.steps, levels, seed + 1);
    return {{"one in a world of the same size", alike},
            {"one in a larger world", world(kind, options_.steps + 3, levels + 2, seed + 1)},
            {"one in a smaller world", world(kind, options_.steps / 2 + 1, levels - 2, seed + 1)},
            {"one with the other kind of quality", world(other, options_.steps, levels, seed + 1)},
            {"one that was broken off at its start", alike, seed + 1, 0},
            {"one that was broken off in its middle", alike, seed + 1, options_.steps / 2},
            {"one that was broken off just before its end", alike, seed + 1, options_.steps - 1},
            {"the same flight, which was broken off in its middle", map_, seed, options_.steps / 2}};
  }

  std::string check_later_flight() {
    if (options_.lifelong) return {};
    std::vector<Earlier> flights = earlier_flights();
    for (const auto& pilot : {fly_as_commanded, fly_half_as_commanded}) {
      const Commands expected = fly_fresh(map_, pilot).commands;
      for (Earlier& earlier : flights) {
        const auto agent = spec_.make();
        fly(earlier.map, *agent, fly_half_as_commanded, earlier.flight_seed, earlier.stop);
        const std::string off = difference(fly(map_, *agent, pilot).commands, expected);
        if (!off.empty())
          return fmt::format(
              "a flight after {} is not like a fresh agent's, it {}: begin() must reset all that the "
              "agent remembers, and take over the new flight's limits, seed and trial",
              earlier.what, off);
      }
    }
    return {};
  }

  void check_limits() {
    const QosKind kind = map_.qos_kind();
    SyntheticMap silent = map_;
    for (std::uint32_t point = 0; point < silent.qos().size(); ++point)
      for (std::uint32_t level = 0; level < levels; ++level) silent.set_qos(point, level, 0.0);
    for (const auto& [what, map] : {std::pair{"a world of one level", world(kind, options_.steps, 1, seed)},
                                    std::pair{"a world of one step", world(kind, 1, levels, seed)},
                                    std::pair{"a world without any quality", silent}}) {
      SyntheticMap copy = map;
      check(what, [&] {
        fly_fresh(copy);
        return "";
      });
    }
  }

  /// As in the crew of a relay: the agent's first report is from the middle of a flight.
  std::string check_comes_aboard_late() {
    for (const std::uint32_t first : {1U, options_.steps / 2, options_.steps - 1}) {
      const std::string off = difference(fly_from(first).commands, fly_from(first).commands);
      if (!off.empty()) return fmt::format("coming aboard at step {} again, it {}", first, off);
    }
    return {};
  }

  Flown fly_from(std::uint32_t first) {
    Flight flight(map_, seed, trial, around_.costs);
    for (std::uint32_t step = 0; step < first; ++step) flight.step(fly_to_both_limits({}, step), "pilot");
    const auto agent = spec_.make();
    agent->begin(flight.info());
    Flown flown;
    while (true) {
      exchange(flight, *agent, flown);
      if (flight.finished()) return flown;
      flight.step(command_, "agent");
    }
  }

  std::string check_checkpoints() {
    const auto agent = spec_.make();
    const Commands expected = fly(map_, *agent, fly_half_as_commanded).commands;
    const std::string state_at_end = agent->save_state();
    for (const std::uint32_t stop : {0U, 1U, options_.steps / 2, options_.steps - 1}) {
      const Interrupted flight = fly_interrupted(stop);
      const std::string when = fmt::format("after the command for step {}", stop + 1);
      if (!flight.problem.empty()) return fmt::format("{}: {}", when, flight.problem);
      std::string off = difference(flight.commands, expected);
      if (off.empty() && flight.state_at_end != state_at_end) off = "ends the flight with another state";
      if (!off.empty())
        return fmt::format(
            "saved {} and restored into a new agent, it {}: save_state() leaves out something that the "
            "future depends on (is save() missing, or a member in it?)",
            when, off);
    }
    return {};
  }

  struct Interrupted {
    Commands commands;
    std::string state_at_end;
    std::string problem;
  };

  /// Saves after the command for step `stop` + 1 and goes on with a new agent.
  Interrupted fly_interrupted(std::uint32_t stop) {
    Flight flight(map_, seed, trial, around_.costs);
    auto agent = spec_.make();
    agent->begin(flight.info());
    Flown flown;
    while (true) {
      exchange(flight, *agent, flown);
      if (flight.finished()) return {flown.commands, agent->save_state(), ""};
      if (flight.observation().step == stop) {
        auto fresh = spec_.make();
        if (const std::string problem = move_state(*agent, *fresh); !problem.empty()) return {{}, "", problem};
        agent = std::move(fresh);
      }
      flight.step(fly_half_as_commanded(command_, flight.observation().step), "pilot");
    }
  }

  std::string move_state(const Agent& agent, Agent& fresh) {
    const std::string state = agent.save_state();
    if (state != agent.save_state()) return "save_state() gives other bytes when it is called again";
    if (std::string problem = check_damage_is_refused(state); !problem.empty()) return problem;
    try {
      fresh.restore_state(state);
    } catch (const std::exception& error) {
      return fmt::format("restore_state() refuses what save_state() gave: {}", error.what());
    }
    if (fresh.save_state() == state) return {};
    return "a restored agent saves another state than the one it was restored from: restore_state() does not read all "
           "that save_state() wrote (is restore() missing, or a member in it?)";
  }

  std::string check_idle_state() {
    const auto agent = spec_.make();
    agent->restore_state(spec_.make()->save_state());
    const Commands expected = fly_fresh(map_, fly_half_as_commanded).commands;
    const std::string off = difference(fly(map_, *agent, fly_half_as_commanded).commands, expected);
    return off.empty() ? "" : "restored from the state of an agent that has never flown, it " + off;
  }

  std::string check_damage_is_refused(const std::string& state) {
    std::vector<std::pair<const char*, std::string>> damages{
        {"an empty state", ""}, {"a text that is no state", "not a state"}, {"a state and a byte more", state + "x"}};
    for (const std::size_t part : {1U, 2U, 3U}) {
      if (state.empty()) break;
      const std::size_t at = state.size() * part / 4;
      damages.emplace_back("a state that is cut", state.substr(0, at));
      damages.emplace_back("a state with an altered bit", state);
      damages.back().second[at] = static_cast<char>(state[at] ^ 1);
    }
    for (const auto& [what, bytes] : damages) {
      try {
        spec_.make()->restore_state(bytes);
        return fmt::format("restore_state() accepts {}: it must throw IntegrityError (StateReader does)", what);
      } catch (const IntegrityError&) {
      } catch (const std::exception& error) {
        return fmt::format("restore_state() answers {} with \"{}\" instead of an IntegrityError", what, error.what());
      }
    }
    return {};
  }

  std::string check_surveying() {
    const auto agent = spec_.make();
    const Flight flight(map_, seed, trial, around_.costs);
    agent->begin(flight.info());
    try {
      agent->survey(flight.site_map(false));
    } catch (const std::logic_error&) {
      return {};
    }
    return "survey() takes a map that an agent without the privilege may not have: declare the privilege in its type, "
           "or leave survey() as Agent has it";
  }

  std::string check_foreseeing() {
    const auto agent = spec_.make();
    agent->begin(Flight(map_, seed, trial, around_.costs).info());
    try {
      agent->foresee(HeightProfile{1, 40.0, 10.0, std::vector<double>(levels)});
    } catch (const std::logic_error&) {
      return {};
    }
    return "foresee() takes what an agent without the privilege may not see: declare the privilege in its type, or "
           "leave foresee() as Agent has it";
  }

  const AgentSpec& spec_;
  const AgentType& type_;
  const ConformanceOptions& options_;
  const Surroundings& around_;
  SyntheticMap map_;
  HeightProfile buffer_;
  Command command_;
  std::string illegal_command_;  // the first
  bool illegal_command_named_ = false;
  std::vector<std::string> problems_;
};

constexpr std::array all_surroundings{
    Surroundings{.name = "spectral efficiency"}, Surroundings{.name = "throughput", .kind = QosKind::throughput},
    Surroundings{.name = "spectral efficiency with handovers", .costs = {.a3 = radio::A3Rules{}}}};

}  // namespace

std::vector<std::string> conformance_problems(const nlohmann::json& entry, const ConformanceOptions& options) {
  std::vector<std::string> all;
  for (const AgentSpec& spec : agents::parse_agents(entry, "agent"))
    for (const Surroundings& around : all_surroundings)
      for (std::string& problem : Kit(spec, options, around).problems()) all.push_back(std::move(problem));
  return all;
}

bool depends_on_unmeasured(const AgentSpec& spec, const ConformanceOptions& options) {
  return std::ranges::any_of(
      all_surroundings, [&](const Surroundings& around) { return Kit(spec, options, around).depends_on_unmeasured(); });
}

bool depends_beyond_next_step(const AgentSpec& spec, const ConformanceOptions& options) {
  return std::ranges::any_of(all_surroundings, [&](const Surroundings& around) {
    return Kit(spec, options, around).depends_beyond_next_step();
  });
}

}  // namespace aloft::flight
