#pragma once

#include <map>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/flight/flight.hpp"
#include "common/world/local_projection.hpp"
#include "common/world/world.hpp"

namespace aloft::exports {

/// Where the middle of a world lies on the globe that has no place there: in the Gulf of Guinea, so that nobody takes
/// it for a real place.
inline constexpr world::GeoPosition nowhere{0.0, 0.0};

/// What can be drawn of the world of a trial. Positions: metres east and north of `origin`.
struct DrawnWorld {
  world::GeoPosition origin = nowhere;
  world::City city;                                  ///< of a measured world: nothing
  std::map<std::int32_t, world::Position> stations;  ///< by cell
  double antenna_height_m = 0.0;                     ///< of every base station
  std::vector<world::Position> route;      ///< on the ground; empty if it depends on the flight or is not known
  std::vector<world::GeoPosition> places;  ///< [step - 1], if a measured flight has them

  /// Where the UAV was in a step.
  [[nodiscard]] world::Position position(const flight::StepRecord& step) const;
  [[nodiscard]] world::GeoPosition place(const flight::StepRecord& step) const;
};

/// Makes the world of a trial anew. Throws InputError as experiment::make_world().
[[nodiscard]] DrawnWorld draw_world(const experiment::Experiment& experiment, const experiment::Condition& condition,
                                    std::uint32_t trial);

}  // namespace aloft::exports
