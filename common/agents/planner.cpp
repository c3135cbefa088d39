#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/agents/smoothed_levels.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// Knows the whole route and flies the best feasible flight: the largest sum of quality with at most one level per
/// step, by dynamic programming (Bellman) from the last step to the first. On ties it prefers hold, then down. With
/// smoothing it knows about what an agent without foresight could know at best: the stations and the buildings, but not
/// the fading.
class Planner final : public SteeringAgent {
 public:
  explicit Planner(const Parameters& parameters)
      : SteeringAgent("planner", parameters), smoothing_m_(parameters.number("smoothing_m")) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    levels_ = level_count(flight);
    quality_.clear();
    actions_.clear();
  }

  void foresee(const HeightProfile& profile) override {
    if (profile.step != quality_.size() / levels_ + 1)
      throw std::logic_error("the planner must be shown all steps in order");
    const std::vector<double> column = smoothed_levels(profile, flight(), smoothing_m_);
    quality_.insert(quality_.end(), column.begin(), column.end());
    if (profile.step == flight().steps) plan();
  }

  Command act() override {
    const std::size_t at = std::size_t{step()} * levels_ + level();
    if (at >= actions_.size()) throw std::logic_error("the planner was not shown the whole route");
    return {static_cast<Action>(actions_[at])};
  }

 private:
  /// Fills actions_ backwards: value[k] is the best sum of the steps still to come from level k.
  void plan() {
    actions_.resize(quality_.size());
    std::vector<double> value(levels_, 0.0);
    std::vector<double> arrival(levels_);
    for (std::size_t step = flight().steps; step-- > 0;) {
      for (std::size_t k = 0; k < levels_; ++k) arrival[k] = quality_[step * levels_ + k] + value[k];
      for (std::size_t k = 0; k < levels_; ++k) {
        Action best = Action::hold;
        value[k] = arrival[k];
        const auto consider = [&](Action action, std::size_t to) {
          if (arrival[to] <= value[k]) return;
          best = action;
          value[k] = arrival[to];
        };
        if (k > 0) consider(Action::down, k - 1);
        if (k + 1 < levels_) consider(Action::up, k + 1);
        actions_[step * levels_ + k] = static_cast<std::int64_t>(best);
      }
    }
  }

  void save(StateWriter& writer) const override { writer.put("plan", actions_); }

  void restore(const StateReader& reader) override {
    levels_ = level_count(flight());
    const auto actions = reader.integers("plan");
    const std::size_t size = std::size_t{flight().steps} * levels_;
    if (!actions.empty() && actions.size() != size) reader.refuse("its plan does not fit its flight");
    if (std::ranges::any_of(actions, [](std::int64_t action) {
          return action < static_cast<std::int64_t>(Action::down) || action > static_cast<std::int64_t>(Action::up);
        }))
      reader.refuse("its plan has an unknown action");
    actions_.assign(actions.begin(), actions.end());
  }

  double smoothing_m_;
  std::size_t levels_ = 1;
  std::vector<double> quality_;        // [(step - 1) * levels_ + level]
  std::vector<std::int64_t> actions_;  // [steps flown * levels_ + level]
};

/// Implied: experiments from before it name no smoothing.
ParameterSpec smoothing() {
  ParameterSpec spec =
      number_parameter("smoothing_m", 0.0, 0.0, 1000.0,
                       "Takes the mean over heights up to this far away, against fading: then no upper bound.");
  spec.default_is_implied = true;
  return spec;
}

const bool planner_registered =
    register_agent({.name = "planner",
                    .description = "Knows the whole route and flies the best flight that is feasible: the upper bound.",
                    .privilege = Privilege::whole_route,
                    .looks = {{"planner", 70, "#c05f94", "#eaa3c6", {4, 2}}},
                    .parameters = {smoothing()},
                    .make = [](const Parameters& parameters) { return std::make_unique<Planner>(parameters); }});

}  // namespace
}  // namespace aloft::agents
