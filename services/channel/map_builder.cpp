#include "services/channel/map_builder.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <exception>
#include <utility>

#include "common/bus/convert.hpp"
#include "common/experiment/trial_world.hpp"

namespace aloft::channel {
namespace {

experiment::TrialWorld trial_world(const wire::World& world) {
  if (world.kind() == wire::WORLD_MEASURED) return bus::measured_world(world);
  return bus::city(world);
}

/// Whether an agent is shown readings at every height. All others need one per step, which is computed when they fly.
bool shows_columns(const experiment::Experiment& experiment) {
  return std::ranges::any_of(experiment.agents,
                             [](const agents::AgentSpec& spec) { return agents::foresees(spec.privilege()); });
}

MapBuilder::Built build(const experiment::Experiment& experiment, const wire::World& world) {
  MapBuilder::Built result;
  result.lease_id = world.lease_id();
  try {
    result.map = experiment::make_signal_map(experiment, experiment.conditions.at(world.condition()), world.trial(),
                                             trial_world(world));
    if (shows_columns(experiment)) result.map->prepare();
  } catch (const std::exception& error) {
    result.map.reset();
    result.error = error.what();
  }
  return result;
}

}  // namespace

MapBuilder::MapBuilder(std::function<void()> on_built) : on_built_(std::move(on_built)) {}

void MapBuilder::submit(std::shared_ptr<const experiment::Experiment> experiment, const wire::World& world) {
  boost::asio::post(thread_, [this, experiment = std::move(experiment), world] {
    Built built = build(*experiment, world);
    {
      const std::lock_guard lock(mutex_);
      built_.push_back(std::move(built));
    }
    on_built_();
  });
}

std::vector<MapBuilder::Built> MapBuilder::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(built_, {});
}

}  // namespace aloft::channel
