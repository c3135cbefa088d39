#include "tools/train/trainer.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/agents/pretrained_model.hpp"
#include "common/base/error.hpp"
#include "tools/train/config.hpp"

using namespace aloft;
using Catch::Contains;
using radio::QosKind;
using train::Trainer;

namespace {

Parameters small_settings(int seed = 5) {
  return {train::stage_parameters(QosKind::throughput),
          {{"seed", seed},
           {"worlds", 20},
           {"validation_worlds", 6},
           {"rounds", 3},
           {"hidden_width", 16},
           {"state_share", 0.1},
           {"reused_rounds", 2},
           {"rollout_steps", 5},
           {"updates", 200}},
          "test"};
}

Trainer make(unsigned threads = 1, const train::Watch& watch = {}) {
  return {QosKind::throughput, small_settings(), threads, watch};
}

std::vector<float> trained(Trainer trainer) {
  while (!trainer.finished()) trainer.train_round();
  return trainer.best_weights();
}

}  // namespace

TEST_CASE("training gives the same weights on any number of threads, and others for another seed") {
  const std::vector<float> weights = trained(make());
  CHECK(weights.size() == agents::pretrained_shape(16).parameters());
  CHECK(trained(make(3)) == weights);
  CHECK(trained({QosKind::throughput, small_settings(6), 1, {}}) != weights);
}

TEST_CASE("a training that goes on from its saved state after any round ends with the same weights and log") {
  Trainer whole = make();
  std::vector<std::string> states;
  while (!whole.finished()) {
    whole.train_round();
    states.push_back(whole.save_state());
  }
  REQUIRE(states.size() == 4);  // the imitation and three rounds
  for (const std::string& state : states) {
    Trainer resumed = make(2);
    resumed.restore_state(state);
    CHECK((resumed.finished() || resumed.save_state() == state));  // a finished training needs no samples
    while (!resumed.finished()) resumed.train_round();
    CHECK(resumed.best_weights() == whole.best_weights());
    CHECK(resumed.validation_log() == whole.validation_log());
  }
}

TEST_CASE("a state of other settings, a truncated and an altered one are refused") {
  Trainer trainer = make();
  trainer.train_round();
  std::string state = trainer.save_state();
  Trainer other(QosKind::throughput, small_settings(6), 1, {});
  CHECK_THROWS_AS(other.restore_state(state), IntegrityError);
  CHECK_THROWS_AS(trainer.restore_state(state.substr(0, state.size() / 2)), IntegrityError);
  state[state.size() / 2] = static_cast<char>(state[state.size() / 2] ^ 1);
  CHECK_THROWS_AS(trainer.restore_state(state), IntegrityError);
}

TEST_CASE("the log has a line per round, and the watch sees every phase and can stop") {
  std::vector<std::string> phases;
  Trainer trainer = make(2, {[&](const std::string& phase, double share) {
                               CHECK((share >= 0.0 && share <= 1.0));
                               if (phases.empty() || phases.back() != phase) phases.push_back(phase);
                             },
                             {}});
  trainer.train_round();
  trainer.train_round();
  CHECK(phases == std::vector<std::string>{"worlds", "round 0 of 3: flights", "round 0 of 3: fit",
                                           "round 0 of 3: validation", "round 1 of 3: flights", "round 1 of 3: fit",
                                           "round 1 of 3: validation"});
  const std::vector<std::string> log = trainer.validation_log();
  REQUIRE(log.size() == 2);
  CHECK_THAT(log[1], Contains("throughput round 1: gain over min-height of the best feasible"));

  int asked = 0;
  CHECK_THROWS_AS(trained(make(1, {{}, [&] { return ++asked > 40; }})), train::Interrupted);
}
