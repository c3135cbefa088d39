#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"
#include "common/flight/testing/conformance.hpp"

using namespace aloft::agents;

TEST_CASE("local-bandit conforms") {
  aloft::flight::check_conformance("local-bandit");
}

TEST_CASE("a state of a flight with impossible heights is refused before memory is asked for") {
  const AgentSpec spec = parse_agents("local-bandit", "agents[0]").front();
  const auto restore = [&](double low_m, double high_m, double step_m) {
    StateWriter writer(spec.type, spec.parameters);
    save_flight(writer, {QosKind::throughput, low_m, high_m, step_m, 10, 1, 0});
    writer.put_number("height_m", low_m);
    writer.put_integer("step", 0);
    spec.make()->restore_state(writer.bytes());
  };
  const double nan = std::nan("");
  for (const auto& [low_m, high_m, step_m] : {std::array{0.0, 1e5, 1e-3},
                                              {-1e300, 1e300, 1e299},
                                              {nan, 100.0, 10.0},
                                              {0.0, nan, 10.0},
                                              {0.0, 100.0, nan},
                                              {100.0, 0.0, 10.0}})
    CHECK_THROWS_WITH(restore(low_m, high_m, step_m), Catch::Contains("impossible heights"));
  CHECK_THROWS_WITH(restore(40.0, 240.0, 10.0), Catch::Contains("'estimate' is missing"));
}

TEST_CASE("local-bandit weighs known, stale and unknown heights") {
  struct Moment {
    double height_m;
    double reward_mbps;
    Action answer;
  };
  // alpha 0.2, optimism 2, bias 0.3, staleness 0.6. The worth of (down, hold, up), computed by hand:
  const Moment moments[] = {
      {40, 0, Action::hold},   // nothing known: (-, 2, 2 exp(-0.3) = 1.48)
      {40, 10, Action::up},    // q0 = 10: (-, 10, 10 + 1.48)
      {50, 8, Action::down},   // q1 = 8: (10 + 0.6, 8, 8 + 2 exp(-0.6) = 9.10)
      {40, 5, Action::hold},   // q0 = 10 + 0.2 (5 - 10) = 9: (-, 9, 8 + 0.6)
      {40, 9, Action::hold},   // (-, 9, 8 + 0.6 sqrt 2 = 8.85)
      {40, 9, Action::up},     // (-, 9, 8 + 0.6 sqrt 3 = 9.04)
      {60, 20, Action::hold},  // another pilot climbed further: q2 = 20, (8 + 0.6 sqrt 4, 20, -)
      {60, 0, Action::hold},   // q2 = 16
  };
  struct Unit {
    QosKind kind;
    double per_mbps;
  };
  for (const Unit unit : {Unit{QosKind::throughput, 1000.0}, Unit{QosKind::spectral_efficiency, 1.0}}) {
    const auto agent = parse_agents({{"type", "local-bandit"},
                                     {"se_alpha", 0.2},
                                     {"se_optimism_bit_s_hz", 2},
                                     {"se_bias", 0.3},
                                     {"se_staleness_bit_s_hz", 0.6}},
                                    "agents[0]")
                           .front()
                           .make();
    agent->begin({.qos = unit.kind, .height_min_m = 40, .height_max_m = 60, .height_step_m = 10, .steps = 9});
    std::uint32_t step = 0;
    for (const Moment& moment : moments) {
      INFO("step " << step);
      agent->observe({.step = step, .height_m = moment.height_m, .reward = moment.reward_mbps * unit.per_mbps});
      CHECK(agent->act().action == moment.answer);
      ++step;
    }
  }
}
