#include "tools/export/drawn_world.hpp"

#include "common/experiment/trial_world.hpp"
#include "common/world/route.hpp"

namespace aloft::exports {
namespace {

DrawnWorld draw_city(const experiment::Condition& condition, const world::City& city) {
  DrawnWorld drawn;
  drawn.city = city;
  drawn.antenna_height_m = city.base_station_height_m;
  for (std::size_t cell = 0; cell < city.base_stations.size(); ++cell)
    drawn.stations[static_cast<std::int32_t>(cell)] = city.base_stations[cell];
  const world::Route route(condition.world, city);
  for (std::uint32_t point = 0; route.fixed() && point <= route.steps(); ++point)
    drawn.route.push_back(route.advance(point, route.start(), -1));
  return drawn;
}

DrawnWorld draw_measured(const experiment::Condition& condition) {
  DrawnWorld drawn;
  const experiment::PlacedWorld measured = experiment::read_placed_world(condition);
  drawn.places = measured.places;
  if (!drawn.places.empty()) {
    drawn.origin = world::mean_position(drawn.places);
    const world::LocalProjection projection(drawn.origin);
    for (const world::GeoPosition& place : drawn.places) drawn.route.push_back(projection(place));
  }
  if (!measured.world.known) return drawn;
  drawn.antenna_height_m = measured.world.known->antenna_height_m;
  for (const world::Site& site : measured.world.known->sites) drawn.stations[site.cell] = site.position;
  return drawn;
}

}  // namespace

world::Position DrawnWorld::position(const flight::StepRecord& step) const {
  return places.empty() ? world::Position{step.x_m, step.y_m} : route.at(step.step - 1);
}

world::GeoPosition DrawnWorld::place(const flight::StepRecord& step) const {
  return places.empty() ? world::LocalProjection(origin).inverse({step.x_m, step.y_m}) : places.at(step.step - 1);
}

DrawnWorld draw_world(const experiment::Experiment& experiment, const experiment::Condition& condition,
                      std::uint32_t trial) {
  if (condition.kind == experiment::WorldKind::measured) return draw_measured(condition);
  return draw_city(condition, experiment::make_city(experiment, condition, trial));
}

}  // namespace aloft::exports
