#include "services/environment/world_maker.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/bus/convert.hpp"
#include "common/bus/validate.hpp"
#include "common/world/city.hpp"
#include "common/world/measured_flight.hpp"

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
    throw InputError(
        fmt::format("the experiment has no condition {} with trial {}", assignment.condition(), assignment.trial()));
  const experiment::Condition& condition = experiment_.conditions[assignment.condition()];
  if (condition.kind == experiment::WorldKind::measured)
    bus::put(world, measured_flight(condition.world));
  else
    bus::put(world, world::generate_city(condition.world, experiment_.seed, assignment.trial()));
}

const world::MeasuredFlight& WorldMaker::measured_flight(const Parameters& world) {
  const std::string& file = world.text("file");
  const auto known = measured_.find(file);
  if (known != measured_.end()) return known->second;
  const std::string csv = read_file(file);
  if (sha256_hex(csv) != world.text("file_sha256"))
    throw InputError(
        fmt::format("{}: its SHA-256 is not {}, with which the experiment was resolved; use the original "
                    "file on every machine",
                    file, world.text("file_sha256")));
  return measured_.emplace(file, world::parse_measured_flight(csv, file)).first->second;
}

}  // namespace aloft::environment
