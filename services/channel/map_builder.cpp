#include "services/channel/map_builder.hpp"

#include <exception>
#include <utility>

#include "common/bus/convert.hpp"
#include "common/experiment/trial_world.hpp"

namespace aloft::channel {
namespace {

experiment::TrialWorld trial_world(const wire::World& world) {
  if (world.kind() == wire::WORLD_MEASURED) return bus::measured_flight(world);
  return bus::city(world);
}

/// Computes all readings of a route that is known beforehand.
void fill(radio::SignalMap& map) {
  const world::Position start = map.start();
  static_cast<void>(map.column(0, start));
  if (!map.fixed_route()) return;
  for (std::uint32_t step = 1; step <= map.steps(); ++step) {
    const std::uint32_t point = map.result_point(step);
    static_cast<void>(map.column(point, map.advance(point, start, -1)));
  }
}

MapBuilder::Built build(const experiment::Experiment& experiment, const wire::World& world) {
  MapBuilder::Built result;
  result.lease_id = world.lease_id();
  try {
    result.map = experiment::make_signal_map(experiment, experiment.conditions.at(world.condition()), world.trial(),
                                             trial_world(world));
    fill(*result.map);
  } catch (const std::exception& error) {
    result.map.reset();
    result.error = error.what();
  }
  return result;
}

}  // namespace

MapBuilder::MapBuilder(std::function<void()> on_built) : on_built_(std::move(on_built)), thread_([this] { work(); }) {}

MapBuilder::~MapBuilder() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MapBuilder::submit(std::shared_ptr<const experiment::Experiment> experiment, const wire::World& world) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back({std::move(experiment), world});
  }
  changed_.notify_all();
}

std::vector<MapBuilder::Built> MapBuilder::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(built_, {});
}

void MapBuilder::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !jobs_.empty(); });
    if (ending_) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    Built built = build(*job.experiment, job.world);
    lock.lock();
    built_.push_back(std::move(built));
    lock.unlock();
    on_built_();
    lock.lock();
  }
}

}  // namespace aloft::channel
