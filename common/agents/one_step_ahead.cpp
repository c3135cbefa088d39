#include <stdexcept>

#include "common/agents/best_height.hpp"
#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// Knows the quality at every height at the place where this step's result will be read, and moves one d towards the
/// best of all these heights (not to the best of the three within reach). It holds only at the best height.
class OneStepAhead final : public SteeringAgent {
 public:
  explicit OneStepAhead(const Parameters& parameters)
      : SteeringAgent("one-step-ahead", parameters), resolution_m_(parameters.number("target_resolution_m")) {}

  void foresee(const HeightProfile& profile) override {
    foreseen_step_ = profile.step;
    target_m_ = best_height_m(profile, resolution_m_);
  }

  Command act() override {
    if (foreseen_step_ != step() + 1) throw std::logic_error("one-step-ahead was not shown the next step");
    if (height_m() == target_m_) return {Action::hold};
    return {target_m_ > height_m() ? Action::up : Action::down};
  }

 private:
  double resolution_m_;
  // Not saved: foresee() sets both before every command.
  std::uint32_t foreseen_step_ = 0;
  double target_m_ = 0.0;
};

const bool one_step_ahead_registered = register_agent(
    {.name = "one-step-ahead",
     .description = "Knows the next step at every height and moves one step towards the best of them.",
     .privilege = Privilege::next_step,
     .looks = {{"one-step-ahead", 50, "#0066bd", "#5993fb", {2, 4}}},
     .parameters = {number_parameter("target_resolution_m", 0, 0, 1'000,
                                     "Distance of the heights it chooses its target from; 0: every height known.")},
     .make = [](const Parameters& parameters) { return std::make_unique<OneStepAhead>(parameters); }});

}  // namespace
}  // namespace aloft::agents
