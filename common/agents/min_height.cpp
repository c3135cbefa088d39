#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

/// Stays at Zmin (the paper's baseline after Zhang), and returns there if another agent has left it.
class MinHeight final : public SteeringAgent {
 public:
  explicit MinHeight(const Parameters& parameters) : SteeringAgent("min-height", parameters) {}

  Command act() override { return {height_m() > flight().height_min_m ? Action::down : Action::hold}; }
};

const bool min_height_registered =
    register_agent({.name = "min-height",
                    .description = "Flies at the lowest allowed height.",
                    .looks = {{"min-height", 0, "#139fce", "#0fbdff", {1, 0}}},
                    .make = [](const Parameters& p) { return std::make_unique<MinHeight>(p); }});

}  // namespace
}  // namespace aloft::agents
