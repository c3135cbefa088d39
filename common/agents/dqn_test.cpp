#include "common/agents/dqn.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/flight/testing/conformance.hpp"

using namespace aloft::agents;  // NOLINT(google-build-using-namespace): a test of this namespace
using Json = nlohmann::json;

namespace {

aloft::Parameters parameters_of(const Json& given = Json::object()) {
  Json small{{"hidden_width", 32}, {"hidden_layers", 2}, {"epochs", 40}};
  small.update(given);
  return {dqn_parameters(), small, "agents[0]"};
}

/// A world of 7 heights, 40 to 100 m, where quality is best at 70 m: 5 there, 1 less per 10 m beside it. The serving
/// SINR follows from the quality; the neighbours are noise.
class Hill {
 public:
  explicit Hill(std::uint64_t seed, std::uint32_t trial = 0, std::uint32_t steps = 100)
      : info_{QosKind::spectral_efficiency, 40, 100, 10, steps, seed, trial}, random_(seed, trial, "hill") {}

  [[nodiscard]] const FlightInfo& info() const { return info_; }
  [[nodiscard]] static double quality(double height_m) { return 5.0 - std::fabs(height_m - 70.0) / 10.0; }

  Observation report(Action executed) {
    if (executed == Action::down) height_m_ = std::max(40.0, height_m_ - 10.0);
    if (executed == Action::up) height_m_ = std::min(100.0, height_m_ + 10.0);
    Observation observation;
    observation.step = step_;
    observation.height_m = height_m_;
    observation.serving_sinr_db = 4.0 * quality(height_m_);
    observation.neighbour_count = 5;
    for (double& sinr_db : observation.neighbour_sinr_db) sinr_db = random_.uniform(-10.0, 0.0);
    observation.executed = executed;
    observation.reward = observation.qos = step_ == 0 ? 0.0 : quality(height_m_);
    observation.last = step_ == info_.steps;
    ++step_;
    return observation;
  }

 private:
  FlightInfo info_;
  aloft::RandomStream random_;
  double height_m_ = 40.0;
  std::uint32_t step_ = 0;
};

struct Flown {
  std::vector<Action> actions;
  std::vector<double> rewards;
  Introspection last;
};

/// Flies to the end; the agent goes through a checkpoint into a new object after `checkpoint` steps.
Flown fly(Agent& agent, Hill hill, const aloft::Parameters* parameters = nullptr, std::size_t checkpoint = 0) {
  Flown flown;
  Dqn second(parameters != nullptr ? *parameters : parameters_of());
  Agent* pilot = &agent;
  pilot->begin(hill.info());
  Observation observation = hill.report(Action::none);
  pilot->observe(observation);
  while (!observation.last) {
    const Command command = pilot->act();
    flown.actions.push_back(command.action);
    flown.last = command.introspection.value();
    if (parameters != nullptr && flown.actions.size() == checkpoint) {
      second.restore_state(pilot->save_state());
      pilot = &second;
    }
    observation = hill.report(command.action);
    flown.rewards.push_back(observation.reward);
    pilot->observe(observation);
  }
  return flown;
}

double late_mean(const Flown& flown) {
  const std::size_t half = flown.rewards.size() / 2;
  double sum = 0;
  for (std::size_t i = half; i < flown.rewards.size(); ++i) sum += flown.rewards[i];
  return sum / static_cast<double>(flown.rewards.size() - half);
}

std::string error_of(const Json& given) {
  try {
    const Dqn agent(parameters_of(given));
  } catch (const aloft::InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("dqn conforms") {
  aloft::flight::check_conformance({{"type", "dqn"}, {"hidden_width", 16}, {"epochs", 5}});
  aloft::flight::check_conformance({{"type", "dqn"}, {"hidden_width", 16}, {"epochs", 5}, {"memory", "lifelong"}},
                                   {.lifelong = true});
}

TEST_CASE("the DQN finds the best height of a hill") {
  // A uniform choice of heights would give 3.3, staying at the start 2; the optimum is 5. Some flights lock in one
  // action early and never recover, as the paper's DQN does; the median one must not.
  std::vector<double> means;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Dqn agent(parameters_of({{"discount", 0.5}}));
    means.push_back(late_mean(fly(agent, Hill(seed, 0, 300))));
  }
  std::sort(means.begin(), means.end());
  CHECK(means[2] > 4.5);
}

TEST_CASE("with nothing to gain later, Q-values are the rewards") {
  Dqn agent(parameters_of({{"discount", 0.0}, {"epochs", 100}, {"reward", "absolute"}}));
  const Flown flown = fly(agent, Hill(1));
  const double chosen = *std::max_element(flown.last.q_values.begin(), flown.last.q_values.end());
  CHECK(chosen == Approx(flown.rewards.back()).margin(0.5));
  CHECK(flown.last.loss < 0.05);
  CHECK(flown.last.epsilon == Approx(0.05));
}

TEST_CASE("equal seeds and trials give equal flights, another trial a different one") {
  Dqn first(parameters_of());
  Dqn second(parameters_of());
  const std::vector<Action> actions = fly(first, Hill(5)).actions;
  CHECK(fly(second, Hill(5)).actions == actions);
  CHECK(fly(second, Hill(5)).actions == actions);  // per-flight memory: nothing is carried over
  CHECK(fly(second, Hill(5, 1)).actions != actions);
}

TEST_CASE("a checkpoint in mid-flight changes no command") {
  for (const Json& given : {Json::object(), Json{{"memory", "lifelong"}, {"input_scaling", "linear-max"}},
                            Json{{"target_network", false}, {"reward", "absolute"}, {"replay_capacity", 20}}}) {
    const aloft::Parameters parameters = parameters_of(given);
    Dqn uninterrupted(parameters);
    const Flown expected = fly(uninterrupted, Hill(3));
    for (const std::size_t checkpoint : {1U, 5U, 30U, 77U}) {
      INFO(given << " at step " << checkpoint);
      Dqn agent(parameters);
      const Flown flown = fly(agent, Hill(3), &parameters, checkpoint);
      CHECK(flown.actions == expected.actions);
      CHECK(flown.last.q_values == expected.last.q_values);
      CHECK(flown.last.loss == expected.last.loss);
    }
  }
}

TEST_CASE("a checkpoint is restored exactly, and a refused one leaves the agent as it was") {
  const aloft::Parameters parameters = parameters_of();
  Dqn agent(parameters);
  const Dqn fresh(parameters);
  Dqn copy(parameters);
  copy.restore_state(fresh.save_state());
  CHECK(copy.save_state() == fresh.save_state());
  fly(agent, Hill(3));
  const std::string state = agent.save_state();
  copy.restore_state(state);
  CHECK(copy.save_state() == state);
  CHECK_THROWS_AS(copy.restore_state(state.substr(0, state.size() / 2)), aloft::IntegrityError);
  CHECK(copy.save_state() == state);
  Dqn other(parameters_of({{"discount", 0.9}}));
  CHECK_THROWS_WITH(other.restore_state(state), Catch::Contains("other parameters"));
}

TEST_CASE("every option changes what is learnt") {
  Dqn standard(parameters_of());
  const Flown expected = fly(standard, Hill(2));
  for (const Json& given :
       {Json{{"neighbours", 5}}, Json{{"history", 2}}, Json{{"input_scaling", "linear-max"}},
        Json{{"loss", "cross-entropy"}}, Json{{"target_network", false}}, Json{{"reward", "absolute"}},
        Json{{"reward", "difference"}}, Json{{"learning_rate", 1e-4}}, Json{{"discount", 0.5}},
        Json{{"epsilon_start", 0.5}}, Json{{"epsilon_decay", 0.5}}, Json{{"epsilon_floor", 0.5}},
        Json{{"replay_capacity", 30}}, Json{{"minibatch", 8}}, Json{{"epochs", 10}}, Json{{"target_copy_steps", 1}},
        Json{{"hidden_width", 40}}, Json{{"hidden_layers", 3}}}) {
    INFO(given);
    Dqn agent(parameters_of(given));
    const Flown flown = fly(agent, Hill(2));
    CHECK(flown.last.q_values != expected.last.q_values);
    CHECK(std::all_of(flown.last.q_values.begin(), flown.last.q_values.end(),
                      [](double q) { return std::isfinite(q) && q >= 0.0; }));
  }
}

TEST_CASE("lifelong memory carries what was learnt to the next flight") {
  Dqn agent(parameters_of({{"memory", "lifelong"}}));
  fly(agent, Hill(4, 0));
  const Flown second = fly(agent, Hill(4, 1));
  Dqn novice(parameters_of({{"memory", "lifelong"}}));
  CHECK(second.actions != fly(novice, Hill(4, 1)).actions);
  CHECK(second.last.epsilon == 0.05);

  FlightInfo measured = Hill(4).info();
  measured.qos = QosKind::throughput;
  CHECK_THROWS_WITH(agent.begin(measured), Catch::Contains("do not mix generated and measured flights"));
}

TEST_CASE("memory carried as bytes from flight to flight equals that of one agent that flies them all") {
  for (const Json& given : {Json{{"memory", "lifelong"}}, Json{{"memory", "lifelong"},
                                                               {"target_network", false},
                                                               {"loss", "cross-entropy"},
                                                               {"input_scaling", "linear-max"}}}) {
    Dqn flies_on(parameters_of(given));
    std::string memory;
    for (std::uint32_t trial = 0; trial < 3; ++trial) {
      Dqn heir(parameters_of(given));
      if (trial > 0) heir.restore_state(memory);
      CHECK(fly(heir, Hill(4, trial)).actions == fly(flies_on, Hill(4, trial)).actions);
      memory = heir.save_state();
      CHECK(memory == flies_on.save_state());
      CHECK(memory.size() < aloft::limits::memory_bytes);
    }
  }
}

TEST_CASE("trials are dealt to lineages only if memory is lifelong") {
  const auto spec = [](const Json& more) {
    Json entry{{"type", "dqn"}, {"lineages", 3}};
    entry.update(more);
    return parse_agents(entry, "agents[0]").at(0);
  };
  CHECK(spec(Json::object()).lineages() == 0);
  CHECK_FALSE(spec(Json::object()).remembered_trial(7));
  const AgentSpec lifelong = spec({{"memory", "lifelong"}});
  CHECK(lifelong.lineages() == 3);
  CHECK_FALSE(lifelong.remembered_trial(2));
  CHECK(lifelong.remembered_trial(3) == 0U);
  CHECK(lifelong.remembered_trial(7) == 4U);
  CHECK(parse_agents("min-height", "agents[0]").at(0).lineages() == 0);
}

TEST_CASE("it learns from the executed action, whichever agent commanded it") {
  // Both observe the same flight of another pilot, so they must learn the same, whatever they would have commanded.
  Dqn asked(parameters_of());
  Dqn silent(parameters_of());
  Hill hill(6);
  aloft::RandomStream pilot(6, 0, "pilot");
  asked.begin(hill.info());
  silent.begin(hill.info());
  Observation observation = hill.report(Action::none);
  Command command;
  while (true) {
    asked.observe(observation);
    silent.observe(observation);
    if (observation.last) break;
    command = asked.act();
    observation = hill.report(static_cast<Action>(1 + pilot.uniform_index(3)));
  }
  const Command after = silent.act();
  CHECK(after.introspection.value().q_values == asked.act().introspection.value().q_values);
  CHECK(after.introspection.value().loss > 0.0);
}

TEST_CASE("Q-values and loss of a diverged network are not shown") {
  const Introspection fine{.epsilon = 0.5, .loss = 1.0, .q_values = {1.0, -2.0, 3.0}};
  CHECK(showable(fine).value().q_values == fine.q_values);
  CHECK_FALSE(showable(std::nullopt));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Introspection thoughts = fine;
    thoughts.loss = bad;
    CHECK_FALSE(showable(thoughts));
    thoughts = fine;
    thoughts.q_values[1] = -bad;
    CHECK_FALSE(showable(thoughts));
  }
}

TEST_CASE("impossible settings and worlds are refused") {
  using Catch::Contains;
  CHECK_THAT(error_of({{"replay_capacity", 10}}), Contains("replay_capacity 10 is smaller than minibatch 16"));
  CHECK_THAT(error_of({{"hidden_width", 30}}), Contains("multiple of 8"));
  CHECK_THAT(error_of({{"neighbours", 3}}), Contains("agents[0].neighbours"));
  CHECK_THAT(error_of({{"memory", "lifelong"}, {"hidden_width", 1024}}), Contains("would carry"));

  Dqn agent(parameters_of());
  Hill hill(1);
  agent.begin(hill.info());
  Observation observation = hill.report(Action::none);
  observation.neighbour_count = 3;
  CHECK_THROWS_WITH(agent.observe(observation), Contains("has 3 neighbour cells, but the state needs 4"));
}
