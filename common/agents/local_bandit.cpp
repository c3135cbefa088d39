#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

constexpr std::int64_t never = -1;

/// Settings in Mbit/s or bit/s/Hz. Those for measured flights came with the algorithm; those for generated worlds are
/// the best of 130 on 300 trials of each of 1, 2.5 and 5 base stations per km2, seed 990001.
struct BanditPreset {
  std::string_view prefix;
  std::string_view unit;
  double alpha;
  double optimism;
  double bias;
  double staleness;
};
constexpr BanditPreset throughput_preset{"throughput", "mbps", 0.2, 2.0, 0.3, 0.6};
constexpr BanditPreset se_preset{"se", "bit_s_hz", 0.9, 6.0, 0.05, 0.6};

constexpr const BanditPreset& preset_of(QosKind kind) {
  return kind == QosKind::throughput ? throughput_preset : se_preset;
}

std::vector<ParameterSpec> bandit_parameters() {
  std::vector<ParameterSpec> table;
  for (const BanditPreset& preset : {throughput_preset, se_preset}) {
    const auto named = [&](std::string_view name) { return fmt::format("{}_{}", preset.prefix, name); };
    table.push_back(number_parameter(named("alpha"), preset.alpha, 0, 1, "Rate of the running average per height."));
    table.push_back(number_parameter(named(fmt::format("optimism_{}", preset.unit)), preset.optimism, -1'000, 1'000,
                                     "Bonus of a height never visited, at Zmin."));
    table.push_back(
        number_parameter(named("bias"), preset.bias, 0, 100, "How fast that bonus falls per level of height."));
    table.push_back(number_parameter(named(fmt::format("staleness_{}", preset.unit)), preset.staleness, 0, 1'000,
                                     "Bonus of a visited height after one step; grows as the root of time."));
  }
  return table;
}

/// A bandit over levels: keeps a running average of the quality of every level, and goes to the best of the three
/// within reach. A visited level is worth its average + staleness * sqrt(steps since the visit), another one the
/// present level's average + optimism * exp(-bias * level).
class LocalBandit final : public SteeringAgent {
 public:
  explicit LocalBandit(const Parameters& parameters) : SteeringAgent("local-bandit", parameters) { forget(); }

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    forget();
  }

  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    if (observation.step == 0) return;  // not scored
    const double reward = in_learning_units(observation.reward, flight().qos);
    double& estimate = estimate_[level()];
    estimate = visited_[level()] == never ? reward : estimate + alpha_ * (reward - estimate);
    visited_[level()] = observation.step;
  }

  Command act() override {
    const std::uint32_t here = level();
    Action best = Action::hold;
    double best_promise = promise(here);
    const auto consider = [&](Action action, std::uint32_t to) {
      const double value = promise(to);
      if (value <= best_promise) return;
      best = action;
      best_promise = value;
    };
    if (here > 0) consider(Action::down, here - 1);
    if (here + 1 < estimate_.size()) consider(Action::up, here + 1);
    return {best};
  }

 private:
  [[nodiscard]] double promise(std::uint32_t to) const {
    if (visited_[to] == never) return estimate_[level()] + optimism_ * std::exp(-bias_ * to);
    return estimate_[to] + staleness_ * std::sqrt(static_cast<double>(step() - visited_[to]));
  }

  void forget() {
    const BanditPreset& preset = preset_of(flight().qos);
    const auto number = [&](std::string_view name) {
      return parameters().number(fmt::format("{}_{}", preset.prefix, name));
    };
    alpha_ = number("alpha");
    optimism_ = number(fmt::format("optimism_{}", preset.unit));
    bias_ = number("bias");
    staleness_ = number(fmt::format("staleness_{}", preset.unit));
    estimate_.assign(level_count(flight()), 0.0);
    visited_.assign(level_count(flight()), never);
  }

  void save(StateWriter& writer) const override {
    writer.put("estimate", estimate_);
    writer.put("visited", visited_);
  }

  void restore(const StateReader& reader) override {
    forget();
    reader.get("estimate", std::span(estimate_));
    reader.get("visited", std::span(visited_));
  }

  double alpha_ = 0.0;
  double optimism_ = 0.0;  // Mbit/s or bit/s/Hz
  double bias_ = 0.0;
  double staleness_ = 0.0;
  std::vector<double> estimate_;       // per level
  std::vector<std::int64_t> visited_;  // per level: the last step there
};

const bool local_bandit_registered =
    register_agent({.name = "local-bandit",
                    .description = "Learns an average per height and explores the neighbouring heights; no network.",
                    .learns = true,
                    .looks = {{"local-bandit", 80, "#d28100", "#ffb200", {2, 4}}},
                    .parameters = bandit_parameters(),
                    .make = [](const Parameters& parameters) { return std::make_unique<LocalBandit>(parameters); }});

}  // namespace
}  // namespace aloft::agents
