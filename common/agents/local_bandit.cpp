#include <cmath>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

constexpr double mbps_per_kbps = 1e-3;
constexpr std::int64_t never = -1;

/// Keeps a running estimate of the quality of every level, and goes to the most promising of the three within reach:
/// a level it knows is worth its estimate + staleness * sqrt(steps since it was there), one it does not know the
/// present level's estimate + optimism * exp(-bias * level).
class LocalBandit final : public SteeringAgent {
 public:
  explicit LocalBandit(const Parameters& parameters)
      : SteeringAgent("local-bandit", parameters),
        alpha_(parameters.number("alpha")),
        optimism_mbps_(parameters.number("optimism_mbps")),
        bias_(parameters.number("bias")),
        staleness_mbps_(parameters.number("staleness_mbps")),
        mbps_per_se_(parameters.number("mbps_per_bit_s_hz")) {
    forget();
  }

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    forget();
  }

  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    if (observation.step == 0) return;  // not scored
    const double reward_mbps =
        observation.reward * (flight().qos == QosKind::throughput ? mbps_per_kbps : mbps_per_se_);
    double& estimate = estimate_mbps_[level()];
    estimate = visited_[level()] == never ? reward_mbps : estimate + alpha_ * (reward_mbps - estimate);
    visited_[level()] = observation.step;
  }

  Command act() override {
    const std::uint32_t here = level();
    Action best = Action::hold;
    double best_mbps = promise_mbps(here);
    const auto consider = [&](Action action, std::uint32_t to) {
      const double promise = promise_mbps(to);
      if (promise <= best_mbps) return;
      best = action;
      best_mbps = promise;
    };
    if (here > 0) consider(Action::down, here - 1);
    if (here + 1 < estimate_mbps_.size()) consider(Action::up, here + 1);
    return {best};
  }

 private:
  [[nodiscard]] double promise_mbps(std::uint32_t to) const {
    if (visited_[to] == never) return estimate_mbps_[level()] + optimism_mbps_ * std::exp(-bias_ * to);
    return estimate_mbps_[to] + staleness_mbps_ * std::sqrt(static_cast<double>(step() - visited_[to]));
  }

  void forget() {
    estimate_mbps_.assign(level_count(flight()), 0.0);
    visited_.assign(level_count(flight()), never);
  }

  void save(StateWriter& writer) const override {
    writer.put("estimate_mbps", estimate_mbps_);
    writer.put("visited", visited_);
  }

  void restore(const StateReader& reader) override {
    forget();
    reader.get("estimate_mbps", std::span(estimate_mbps_));
    reader.get("visited", std::span(visited_));
  }

  double alpha_;
  double optimism_mbps_;
  double bias_;
  double staleness_mbps_;
  double mbps_per_se_;
  std::vector<double> estimate_mbps_;  // per level
  std::vector<std::int64_t> visited_;  // per level: the last step there
};

const bool registered = register_agent(
    {.name = "local-bandit",
     .description = "Learns an average per height and explores the neighbouring heights; no network.",
     .learns = true,
     .parameters = {number_parameter("alpha", 0.2, 0, 1, "Rate of the running average per height."),
                    number_parameter("optimism_mbps", 2, -1'000, 1'000, "Bonus of a height never visited, at Zmin."),
                    number_parameter("bias", 0.3, 0, 100, "How fast that bonus falls per level of height."),
                    number_parameter("staleness_mbps", 0.6, 0, 1'000,
                                     "Bonus of a visited height after one step; grows as the root of time."),
                    number_parameter("mbps_per_bit_s_hz", 4, 1e-3, 1'000,
                                     "In generated worlds: what 1 bit/s/Hz counts as in Mbit/s.")},
     .make = [](const Parameters& parameters) { return std::make_unique<LocalBandit>(parameters); }});

}  // namespace
}  // namespace aloft::agents
