#include <stdexcept>

#include "common/agents/registry.hpp"
#include "common/agents/route_plan.hpp"
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
    plan_ = RoutePlan(level_count(flight));
  }

  void foresee(const HeightProfile& profile) override {
    if (profile.step != plan_.steps() + 1) throw std::logic_error("the planner must be shown all steps in order");
    plan_.expect(smoothed_levels(profile, flight(), smoothing_m_));
    if (profile.step == flight().steps) plan_.solve();
  }

  Command act() override {
    if (plan_.steps() != flight().steps || !plan_.covers(step() + 1))
      throw std::logic_error("the planner was not shown the whole route");
    return {plan_.action(step() + 1, level())};
  }

 private:
  void save(StateWriter& writer) const override { plan_.save(writer); }

  void restore(const StateReader& reader) override {
    plan_ = RoutePlan(level_count(flight()));
    plan_.restore(reader, flight().steps);
    if (plan_.steps() != 0 && plan_.steps() != flight().steps) reader.refuse("its plan does not fit its flight");
  }

  double smoothing_m_;
  RoutePlan plan_{1};
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
                    .looks = {{"planner", 70, "#d673a9", "#ffb1e9", {8, 2, 2, 2}}},
                    .parameters = {smoothing()},
                    .make = [](const Parameters& parameters) { return std::make_unique<Planner>(parameters); }});

}  // namespace
}  // namespace aloft::agents
