#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/agents/height_belief.hpp"
#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// The belief's unit of quality in generated worlds; in measured flights it is the mean of all rewards so far.
constexpr double spectral_efficiency_unit = 20.0;  // bit/s/Hz

/// One set of parameters: the prior, and those of the plan.
struct Preset {
  QualityPrior prior;
  double optimism = 0.0;
  double discount = 0.0;
  std::uint32_t horizon_steps = 1;
};

std::string_view prefix(QosKind kind) {
  return kind == QosKind::throughput ? "throughput_" : "se_";
}

Preset preset_of(const Parameters& parameters, QosKind kind) {
  const auto number = [&](const char* name) { return parameters.number(fmt::format("{}{}", prefix(kind), name)); };
  return {{number("mean"), number("slope"), number("common_sd"), number("profile_sd"), number("profile_range"),
           number("change_sd"), number("change_range"), number("persistence"), number("noise_sd")},
          number("optimism"),
          number("discount"),
          static_cast<std::uint32_t>(number("horizon_steps"))};
}

void append_parameters(std::vector<ParameterSpec>& table, QosKind kind, const Preset& preset) {
  const std::string_view unit = kind == QosKind::throughput ? "the mean reward so far" : "20 bit/s/Hz";
  const auto add = [&](const char* name, double value, double minimum, double maximum, std::string description) {
    table.push_back(
        number_parameter(fmt::format("{}{}", prefix(kind), name), value, minimum, maximum, std::move(description)));
  };
  const QualityPrior& prior = preset.prior;
  add("mean", prior.mean, -100, 100, fmt::format("Expected quality at Zmin, in units of {}.", unit));
  add("slope", prior.slope, -100, 100, "Expected loss of quality per level of height.");
  add("common_sd", prior.common_sd, 0, 100, "Standard deviation of what all heights share during a flight.");
  add("profile_sd", prior.profile_sd, 0, 100, "Standard deviation of each height's constant part.");
  add("profile_range", prior.profile_range, 0.01, 1'000, "Levels over which the constant part is similar.");
  add("change_sd", prior.change_sd, 0, 100, "Standard deviation of the part that changes during the flight.");
  add("change_range", prior.change_range, 0.01, 1'000, "Levels over which the changing part is similar.");
  add("persistence", prior.persistence, 0, 1, "Correlation of the changing part from step to step.");
  add("noise_sd", prior.noise_sd, 1e-6, 100, "Standard deviation of a measurement.");
  add("optimism", preset.optimism, 0, 100, "Standard deviations by which an uncertain height counts as better.");
  add("discount", preset.discount, 0, 1, "Of future quality in the plan, per step.");
  table.push_back(integer_parameter(fmt::format("{}horizon_steps", prefix(kind)), preset.horizon_steps, 1, 1'000,
                                    "Steps that it plans ahead."));
}

std::vector<ParameterSpec> height_filter_parameters() {
  std::vector<ParameterSpec> table;
  append_parameters(table, QosKind::spectral_efficiency,
                    {{.mean = 0.547,
                      .slope = 0.0,
                      .common_sd = 0.0368,
                      .profile_sd = 0.0234,
                      .profile_range = 7.96,
                      .change_sd = 0.1321,
                      .change_range = 3.61,
                      .persistence = 0.837,
                      .noise_sd = 0.0305},
                     0.558,
                     0.870,
                     10});
  append_parameters(table, QosKind::throughput,
                    {{.mean = 0.2794,
                      .slope = 0.032,
                      .common_sd = 0.295,
                      .profile_sd = 0.0867,
                      .profile_range = 6.6,
                      .change_sd = 0.087,
                      .change_range = 0.5,
                      .persistence = 0.934,
                      .noise_sd = 0.0177},
                     1.013,
                     0.83,
                     18});
  return table;
}

/// Keeps a belief about the quality of every height (HeightBelief) and flies the first action of the best plan over the
/// next steps. It needs no training and uses only its rewards.
class HeightFilter final : public SteeringAgent {
 public:
  explicit HeightFilter(const Parameters& parameters) : SteeringAgent("height-filter", parameters), belief_({}, 1) {
    reset();
  }

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    reset();
  }

  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    if (observation.step == 0) return;  // not scored
    reward_sum_ += observation.reward;
    ++rewards_;
    belief_.update(level(), observation.reward);
  }

  /// V_i(k) = U_i(k) + discount * max over |k' - k| <= 1 of V_(i+1)(k'), V after the horizon = 0. Moves to the
  /// reachable level with the largest V_1; holds on a tie.
  Command act() override {
    const double per_unit = data_per_unit();
    std::ranges::fill(value_, 0.0);
    for (std::size_t ahead = preset_.horizon_steps; ahead > 0; --ahead) {
      belief_.outlook(persistence_[ahead], per_unit, preset_.optimism, outlook_);
      if (ahead < preset_.horizon_steps)
        for (std::size_t k = 0; k < outlook_.size(); ++k) outlook_[k] += preset_.discount * value_[best_near(k)];
      std::swap(value_, outlook_);
    }
    const std::size_t here = level();
    const std::size_t to = best_near(here);
    return {to == here ? Action::hold : to < here ? Action::down : Action::up};
  }

 private:
  void reset() {
    preset_ = preset_of(parameters(), flight().qos);
    belief_ = HeightBelief(preset_.prior, level_count(flight()));
    persistence_.assign(preset_.horizon_steps + 1, 1.0);
    for (std::size_t i = 1; i < persistence_.size(); ++i)
      persistence_[i] = persistence_[i - 1] * preset_.prior.persistence;
    value_.assign(belief_.levels(), 0.0);
    outlook_ = value_;
    reward_sum_ = 0.0;
    rewards_ = 0;
  }

  /// The factor from rewards to units of the belief. It is 0, so that only the prior counts, before the first reward
  /// and while all rewards are 0.
  [[nodiscard]] double data_per_unit() const {
    if (flight().qos == QosKind::spectral_efficiency) return 1.0 / spectral_efficiency_unit;
    return reward_sum_ > 0.0 ? static_cast<double>(rewards_) / reward_sum_ : 0.0;
  }

  /// The level with the largest value among `k` and its neighbours; on a tie k itself, then the lower one.
  [[nodiscard]] std::size_t best_near(std::size_t k) const {
    std::size_t best = k;
    if (k > 0 && value_[k - 1] > value_[best]) best = k - 1;
    if (k + 1 < value_.size() && value_[k + 1] > value_[best]) best = k + 1;
    return best;
  }

  void save(StateWriter& writer) const override {
    belief_.save(writer);
    writer.put_number("reward_sum", reward_sum_);
    writer.put_integer("rewards", rewards_);
  }

  void restore(const StateReader& reader) override {
    reset();
    belief_.restore(reader);
    reward_sum_ = reader.number("reward_sum");
    rewards_ = reader.integer("rewards");
  }

  Preset preset_;
  HeightBelief belief_;
  double reward_sum_ = 0.0;  // unit of the flight's quality
  std::uint64_t rewards_ = 0;
  std::vector<double> persistence_;  // [i]: correlation of the changing part over i steps
  // Scratch memory of act(), per level.
  std::vector<double> value_;
  std::vector<double> outlook_;
};

const bool height_filter_registered = register_agent(
    {.name = "height-filter",
     .description = "Learns the quality of every height with a Kalman filter and plans a few steps ahead.",
     .learns = true,
     .looks = {{"height-filter", default_rank, "#006e0d", "#48a068", {8, 2, 2, 2}}},
     .parameters = height_filter_parameters(),
     .make = [](const Parameters& parameters) { return std::make_unique<HeightFilter>(parameters); }});

}  // namespace
}  // namespace aloft::agents
