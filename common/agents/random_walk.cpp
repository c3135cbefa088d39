#include <array>

#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"
#include "common/base/random.hpp"

namespace aloft::agents {
namespace {

constexpr const char* stream_name = "random-walk";

/// Down, hold or up with probability 1/3 each.
class RandomWalk final : public SteeringAgent {
 public:
  explicit RandomWalk(const Parameters& parameters) : SteeringAgent("random-walk", parameters) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    random_ = RandomStream(flight.seed, flight.trial, stream_name);
  }

  Command act() override {
    constexpr std::array actions{Action::down, Action::hold, Action::up};
    return {actions.at(random_.uniform_index(actions.size()))};
  }

 private:
  void save(StateWriter& writer) const override { writer.put_integer("random.position", random_.position()); }

  void restore(const StateReader& reader) override {
    random_ = RandomStream(flight().seed, flight().trial, stream_name);
    random_.seek(reader.integer("random.position"));
  }

  RandomStream random_{0, 0, stream_name};
};

const bool random_walk_registered =
    register_agent({.name = "random-walk",
                    .description = "Goes down, holds or goes up with equal probability.",
                    .looks = {{"random-walk", 40, "#89868e", "#abaaab", {2, 4}}},
                    .make = [](const Parameters& parameters) { return std::make_unique<RandomWalk>(parameters); }});

}  // namespace
}  // namespace aloft::agents
