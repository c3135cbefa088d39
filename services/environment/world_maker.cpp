#include "services/environment/world_maker.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/base/error.hpp"
#include "common/bus/convert.hpp"
#include "common/bus/validate.hpp"
#include "common/experiment/trial_world.hpp"

namespace aloft::environment {

wire::World WorldMaker::make(const wire::TrialAssignment& assignment) {
  wire::World world;
  world.experiment_id(assignment.experiment_id());
  world.lease_id(assignment.lease_id());
  world.condition(assignment.condition());
  world.trial(assignment.trial());
  world.attempt(assignment.attempt());
  world.agents(assignment.agents());
  world.kind(wire::WORLD_CANCELLED);
  if (assignment.cancelled()) return world;
  try {
    fill(world, assignment);
    if (const char* error = bus::validate(world))
      throw std::runtime_error(fmt::format("no world to fly in: {}", error));
  } catch (const std::exception& error) {
    spdlog::error("condition {}, trial {}: {}", assignment.condition(), assignment.trial(), error.what());
    world.city({});
    world.measured({});
    world.kind(wire::WORLD_FAILED);
    world.error(wire::message(error.what()));
  }
  return world;
}

void WorldMaker::fill(wire::World& world, const wire::TrialAssignment& assignment) {
  if (assignment.condition() >= experiment_.conditions.size() || assignment.trial() >= experiment_.trials)
    throw InputError("the experiment has no condition {} with trial {}", assignment.condition(), assignment.trial());
  const experiment::Condition& condition = experiment_.conditions[assignment.condition()];
  if (condition.kind == experiment::WorldKind::generated)
    return bus::put(world, experiment::make_city(experiment_, condition, assignment.trial()));
  auto flight = flights_.find(condition.index);
  if (flight == flights_.end())
    flight = flights_.emplace(condition.index, experiment::read_measured_world(condition)).first;
  bus::put(world, flight->second);
}

}  // namespace aloft::environment
