#include <algorithm>
#include <cmath>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// Climbs d per step to the level nearest to its height, and stays.
class Constant final : public SteeringAgent {
 public:
  explicit Constant(const Parameters& parameters)
      : SteeringAgent("constant", parameters), target_m_(parameters.number("height_m")) {}

  Command act() override {
    const double away_m = std::clamp(target_m_, flight().height_min_m, flight().height_max_m) - height_m();
    if (std::fabs(away_m) <= 0.5 * flight().height_step_m) return {Action::hold};
    return {away_m > 0.0 ? Action::up : Action::down};
  }

 private:
  double target_m_;
};

const bool constant_registered = register_agent(
    {.name = "constant",
     .description = "Climbs or descends to one height and stays there.",
     .rank = 30,
     .looks = {{"constant-60", 10, "#8e9642", "#e9e568", {3, 2}},
               {"constant-120", 20, "#8e1b4b", "#b34c77", {8, 2, 2, 2, 2, 2}},
               {"constant-240", 30, "#805db7", "#af88d9", {3, 2}}},
     .name_parameter = "height_m",
     .parameters = {number_parameter("height_m", 120, 0, 10'000, "The height; cut to the world's limits.")},
     .make = [](const Parameters& parameters) { return std::make_unique<Constant>(parameters); }});

}  // namespace
}  // namespace aloft::agents
