#pragma once

#include <cstdint>
#include <map>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "common/world/measured_world.hpp"

namespace aloft::environment {

/// Makes the world of an assignment. Never throws for a bad assignment or an unreadable file: the world then says what
/// is wrong (WORLD_FAILED).
class WorldMaker {
 public:
  /// `experiment` must outlive it.
  explicit WorldMaker(const experiment::Experiment& experiment) : experiment_(experiment) {}

  [[nodiscard]] wire::World make(const wire::TrialAssignment& assignment);

 private:
  void fill(wire::World& world, const wire::TrialAssignment& assignment);

  const experiment::Experiment& experiment_;
  std::map<std::uint32_t, world::MeasuredWorld> flights_;  // by condition: read once
};

}  // namespace aloft::environment
