#include "common/radio/sites.hpp"

#include "common/radio/radio_model.hpp"

namespace aloft::radio {

world::City city_of(const Parameters& world, const std::vector<world::Site>& sites) {
  world::City city;
  city.window_m = world.number("window_m");
  city.base_station_height_m = world.number("base_station_height_m");
  for (const world::Site& site : sites) city.base_stations.push_back(site.position);
  return city;
}

std::vector<double> sector_half_turns(const Parameters& world, const std::vector<world::Site>& sites) {
  std::vector<double> half_turns;
  if (RadioModel(world).bs_antenna == BsAntenna::array) return half_turns;
  for (const world::Site& site : sites) half_turns.push_back(site.azimuth_deg / 180.0);
  return half_turns;
}

}  // namespace aloft::radio
