#include "services/channel/map_builder.hpp"

#include <stdexcept>
#include <utility>

#include "common/bus/convert.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/measured_map.hpp"

namespace aloft::channel {
namespace {

std::unique_ptr<radio::SignalMap> make_map(const experiment::Experiment& experiment, const wire::World& world) {
  const experiment::Condition& condition = experiment.conditions.at(world.condition());
  if ((condition.kind == experiment::WorldKind::measured) != (world.kind() == wire::WORLD_MEASURED))
    throw std::runtime_error("the world is not of the condition's kind");
  if (world.kind() == wire::WORLD_MEASURED) return radio::make_measured_map(bus::measured_flight(world));
  if (std::cmp_less(world.city().base_stations().size(), condition.world.integer("min_base_stations")))
    throw std::runtime_error("the city has fewer base stations than the condition asks for");
  return radio::make_generated_map(condition.world, bus::city(world), experiment.seed, world.trial());
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
    result.map = make_map(experiment, world);
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
