// Each agent here breaks one promise, and the kit must find it.
#include "common/flight/testing/conformance.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"
#include "common/base/error.hpp"
#include "common/base/random.hpp"

using namespace aloft::agents;  // NOLINT(google-build-using-namespace): a test of agents
using namespace aloft::flight;  // NOLINT(google-build-using-namespace): a test of this namespace
using aloft::Parameters;
using aloft::RandomStream;
using Catch::Contains;

namespace {

/// Goes to the level with the best reward so far, and now and then to a random one. It keeps every promise.
class Sound : public SteeringAgent {
 public:
  explicit Sound(const Parameters& parameters) : SteeringAgent("sound", parameters) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    best_reward_ = -1.0;
    best_level_ = 0;
    random_ = RandomStream(flight.seed, flight.trial, "sound");
  }
  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    if (observation.step == 0 || observation.reward <= best_reward_) return;
    best_reward_ = observation.reward;
    best_level_ = level();
  }
  Command act() override {
    const std::uint32_t dice = random_.uniform_index(8);
    if (dice < 3) return {std::array{Action::down, Action::hold, Action::up}.at(dice)};
    return {best_level_ > level() ? Action::up : best_level_ < level() ? Action::down : Action::hold};
  }

 protected:
  void save(StateWriter& writer) const override {
    writer.put_number("best_reward", best_reward_);
    writer.put_integer("best_level", best_level_);
    writer.put_integer("random.position", random_.position());
  }
  void restore(const StateReader& reader) override {
    best_reward_ = reader.number("best_reward");
    best_level_ = static_cast<std::uint32_t>(reader.integer("best_level"));
    random_ = RandomStream(flight().seed, flight().trial, "sound");
    random_.seek(reader.integer("random.position"));
  }

  double best_reward_ = -1.0;
  std::uint32_t best_level_ = 0;
  RandomStream random_{0, 0, "sound"};
};

// --- commands ---

struct CommandsNothing : Sound {
  using Sound::Sound;
  Command act() override { return {Action::none}; }
};
struct Jumps : Sound {
  using Sound::Sound;
  Command act() override { return {Action::absolute, 60.0}; }
};
struct JumpsTooHigh : Sound {
  using Sound::Sound;
  Command act() override { return {Action::absolute, flight().height_max_m + 10.0}; }
};

// --- a pure function of the calls ---

struct CountsAllFlights : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    Sound::begin(flight);
    ++flights;
  }
  Command act() override { return flights % 2 == 0 ? Sound::act() : Command{Action::up}; }
  static inline int flights = 0;
};
struct ForgetsToReset : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);  // NOLINT(bugprone-parent-virtual-call): leaves out what Sound resets
    random_ = RandomStream(flight.seed, flight.trial, "sound");
  }
};
struct ResetsAtTheEnd : ForgetsToReset {
  using ForgetsToReset::ForgetsToReset;
  void observe(const Observation& observation) override {
    Sound::observe(observation);
    if (observation.last) Sound::begin(flight());  // NOLINT(bugprone-parent-virtual-call): all of it
  }
};
struct KeepsTheFirstSeed : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    if (first_.steps == 0) first_ = flight;
    Sound::begin(flight);
    random_ = RandomStream(first_.seed, first_.trial, "sound");
  }
  void restore(const StateReader& reader) override {
    Sound::restore(reader);
    first_ = flight();
  }
  FlightInfo first_;
};
struct KeepsTheFirstKind : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    Sound::begin(flight);
    if (!kind_) kind_ = flight.qos;
  }
  Command act() override { return !kind_ || kind_ == flight().qos ? Sound::act() : Command{Action::up}; }
  std::optional<QosKind> kind_;
};

// --- save and restore ---

struct NoSaveNoRestore : Sound {
  using Sound::Sound;
  void save(StateWriter& /*writer*/) const override {}
  void restore(const StateReader& /*reader*/) override {}
};
struct NoRestore : Sound {
  using Sound::Sound;
  void restore(const StateReader& /*reader*/) override {}
};
struct SavesHalf : Sound {
  using Sound::Sound;
  void save(StateWriter& writer) const override { writer.put_integer("random.position", random_.position()); }
  void restore(const StateReader& reader) override {
    random_ = RandomStream(flight().seed, flight().trial, "sound");
    random_.seek(reader.integer("random.position"));
  }
};
struct SavesTheTime : Sound {
  using Sound::Sound;
  void save(StateWriter& writer) const override {
    Sound::save(writer);
    writer.put_integer("saved", static_cast<std::uint64_t>(++saved));
  }
  static inline int saved = 0;
};
struct RefusesItself : Sound {
  using Sound::Sound;
  void restore(const StateReader& reader) override { reader.refuse("it is not mine"); }
};

/// Has no memory, and a state that is not made by StateWriter.
struct OwnState : Agent {
  explicit OwnState(const Parameters& /*parameters*/) {}
  void begin(const FlightInfo& /*flight*/) override {}
  void observe(const Observation& /*observation*/) override {}
  Command act() override { return {Action::hold}; }
  [[nodiscard]] std::string save_state() const override { return "I hold"; }
};
struct AcceptsDamage : OwnState {
  using OwnState::OwnState;
  void restore_state(std::string_view /*bytes*/) override {}
};
struct ThrowsAnything : OwnState {
  using OwnState::OwnState;
  void restore_state(std::string_view bytes) override {
    if (bytes != save_state()) throw std::out_of_range("basic_string::at");
  }
};
struct HasNoState : OwnState {
  using OwnState::OwnState;
  [[nodiscard]] std::string save_state() const override { return ""; }
  void restore_state(std::string_view /*bytes*/) override {}
};

// --- reports, pilots and worlds ---

struct TakesTheFuture : Sound {
  using Sound::Sound;
  void foresee(const HeightProfile& /*profile*/) override {}
};
struct FliesAlone : Sound {
  using Sound::Sound;
  void observe(const Observation& observation) override {
    Sound::observe(observation);
    if (observation.executed == Action::absolute) throw std::runtime_error("I did not command this");
  }
};
struct KnowsOneKind : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    if (flight.qos == QosKind::throughput) throw std::runtime_error("what is a kbit?");
    Sound::begin(flight);
  }
};
struct KnowsTheStartOnly : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    Sound::begin(flight);
    started_ = false;
  }
  void observe(const Observation& observation) override {
    if (!started_ && observation.step > 0) throw std::runtime_error("where did this flight start?");
    started_ = true;
    Sound::observe(observation);
  }
  void restore(const StateReader& reader) override {
    Sound::restore(reader);
    started_ = true;
  }
  bool started_ = false;
};
struct NeedsTwoLevels : Sound {
  using Sound::Sound;
  Command act() override {
    if (level_count(flight()) < 2) throw std::runtime_error("no second level");
    return Sound::act();
  }
};
struct NeedsTwoSteps : Sound {
  using Sound::Sound;
  void begin(const FlightInfo& flight) override {
    if (flight.steps < 2) throw std::runtime_error("no second step");
    Sound::begin(flight);
  }
};
struct NeedsQuality : Sound {
  using Sound::Sound;
  void observe(const Observation& observation) override {
    if (observation.step > 0 && observation.reward == 0.0) throw std::runtime_error("no quality");
    Sound::observe(observation);
  }
};

/// The problems that the kit finds in an agent of this class.
template <class Tested>
std::vector<std::string> problems_of(const char* type, bool unconstrained = false) {
  register_agent({.name = type,
                  .description = "For tests.",
                  .unconstrained = unconstrained,
                  .make = [](const Parameters& parameters) { return std::make_unique<Tested>(parameters); }});
  return conformance_problems(type);
}

/// The kit must report problems, and each must have the agent's name and `what` in it.
template <class Broken>
void check_named(const char* type, const char* what, bool unconstrained = false) {
  const std::vector<std::string> problems = problems_of<Broken>(type, unconstrained);
  INFO(type);
  CHECK_FALSE(problems.empty());
  for (const std::string& problem : problems)
    CHECK_THAT(problem, Contains(std::string("agent ") + type + ",") && Contains(what));
}

AgentSpec spec(const char* type) {
  return parse_agents(type, "agent").front();
}

}  // namespace

TEST_CASE("an agent that keeps every promise has no problems") {
  CHECK(problems_of<Sound>("sound").empty());
}

TEST_CASE("commands that are not allowed are named") {
  check_named<CommandsNothing>("commands-nothing", "commands none for step 1: it is none of down, hold and up");
  check_named<Jumps>("jumps", "commands a jump to 60 m for step 1: its type is not declared unconstrained");
  check_named<JumpsTooHigh>("jumps-too-high", "m for step 1: the limits are 40 to ", true);
}

TEST_CASE("an agent that carries memory or settings from flight to flight is named") {
  check_named<CountsAllFlights>("counts-all-flights", "the same flight again commands");
  check_named<ForgetsToReset>("forgets-to-reset", "begin() must reset all that the agent remembers");
  check_named<ResetsAtTheEnd>("resets-at-the-end", "begin() must reset all that the agent remembers");
  check_named<KeepsTheFirstSeed>("keeps-the-first-seed", "take over the new flight's limits, seed and trial");
  check_named<KeepsTheFirstKind>("keeps-the-first-kind", "a flight after one with the other kind of quality is not");
}

TEST_CASE("memory that save() or restore() leaves out is reported, with the function at fault") {
  check_named<NoSaveNoRestore>("no-save-no-restore", "is save() missing, or a member in it?");
  check_named<SavesHalf>("saves-half", "is save() missing, or a member in it?");
  check_named<NoRestore>("no-restore", "is restore() missing, or a member in it?");
  check_named<SavesTheTime>("saves-the-time", "save_state() gives other bytes when it is called again");
  check_named<RefusesItself>("refuses-itself", "it is not mine");
}

TEST_CASE("an agent that accepts a damaged state is named") {
  check_named<AcceptsDamage>("accepts-damage", "it must throw IntegrityError");
  check_named<ThrowsAnything>("throws-anything", "instead of an IntegrityError");
  check_named<HasNoState>("has-no-state", "restore_state() accepts an empty state");
}

TEST_CASE("an agent that fails in a legal flight is named, together with the flight") {
  check_named<TakesTheFuture>("takes-the-future", "foresee() takes what an agent without the privilege may not see");
  check_named<FliesAlone>("flies-alone", "throws \"I did not command this\"");
  check_named<KnowsOneKind>("knows-one-kind", "throws \"what is a kbit?\"");
  check_named<KnowsTheStartOnly>("knows-the-start-only",
                                 "coming aboard in mid-flight: throws \"where did this flight start?\"");
  check_named<NeedsTwoLevels>("needs-two-levels", "a world of one level: throws \"no second level\"");
  check_named<NeedsTwoSteps>("needs-two-steps", "a world of one step: throws \"no second step\"");
  check_named<NeedsQuality>("needs-quality", "a world without any quality: throws \"no quality\"");
}

TEST_CASE("the kit detects knowledge of unmeasured quality, and of steps beyond the next") {
  CHECK_FALSE(depends_on_unmeasured(spec("sound")));
  CHECK(depends_on_unmeasured(spec("one-step-ahead")));
  CHECK(depends_on_unmeasured(spec("optimal-height")));
  CHECK_FALSE(depends_beyond_next_step(spec("one-step-ahead")));
  CHECK(depends_beyond_next_step(spec("planner")));
}
