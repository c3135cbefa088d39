#include <stdexcept>

#include "common/agents/best_height.hpp"
#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// Jumps to the best height of the next step: a reference that no UAV could fly.
class OptimalHeight final : public SteeringAgent {
 public:
  explicit OptimalHeight(const Parameters& parameters) : SteeringAgent("optimal-height", parameters) {}

  void foresee(const HeightProfile& profile) override {
    foreseen_step_ = profile.step;
    target_m_ = best_height_m(profile, 0.0);
  }

  Command act() override {
    if (foreseen_step_ != step() + 1) throw std::logic_error("optimal-height was not shown the next step");
    return {Action::absolute, target_m_};
  }

 private:
  // Not saved: foresee() sets both before every command.
  std::uint32_t foreseen_step_ = 0;
  double target_m_ = 0.0;
};

const bool optimal_height_registered =
    register_agent({.name = "optimal-height",
                    .description = "Jumps to the best of all heights in every step: the unconstrained reference.",
                    .privilege = Privilege::next_step,
                    .unconstrained = true,
                    .looks = {{"optimal-height", 60, "#00935d", "#00ca7d", {14, 2, 4, 2}}},
                    .make = [](const Parameters& parameters) { return std::make_unique<OptimalHeight>(parameters); }});

}  // namespace
}  // namespace aloft::agents
