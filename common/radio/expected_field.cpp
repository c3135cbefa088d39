#include "common/radio/expected_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/radio/sites.hpp"
#include "common/world/city.hpp"

namespace aloft::radio {
namespace {

world::City with_buildings(world::City city, const Parameters& world, std::uint64_t seed, std::uint32_t trial) {
  world::draw_buildings(world, seed, trial, city);
  return city;
}

HeightGrid levels_of(const Parameters& world) {
  HeightGrid heights = height_grid(world);
  heights.resolution_m = heights.height_step_m;
  return heights;
}

Fading no_fading(RadioModel model) {
  model.fading = FadingKind::none;
  return {model, 0, 0};
}

double undisturbed(const RadioModel& model) {
  return model.fading == FadingKind::none ? 1.0 : std::exp(-std::numbers::egamma);
}

}  // namespace

ExpectedField::ExpectedField(const Parameters& world, const std::vector<world::Site>& sites)
    : scene_(world, city_of(world, sites), 0, 0, levels_of(world), sector_half_turns(world, sites)),
      builder_(scene_, no_fading(scene_.model()), {.line_of_sight = true, .undisturbed = undisturbed(scene_.model())}) {
}

ExpectedField::ExpectedField(const Parameters& world, const std::vector<world::Site>& sites, std::uint64_t seed,
                             std::uint32_t trial)
    : scene_(world, with_buildings(city_of(world, sites), world, seed, trial), seed, trial, levels_of(world),
             sector_half_turns(world, sites)),
      builder_(scene_, no_fading(scene_.model()), {.undisturbed = undisturbed(scene_.model())}) {}

void ExpectedField::column(world::Position position, double* efficiency) {
  if (scene_.stations() == 0)
    std::fill_n(efficiency, levels(), 0.0);
  else
    builder_.sum_candidates(0, position, efficiency);
}

double ExpectedField::blocked_share(const std::vector<world::Position>& places) const {
  std::size_t blocked = 0;
  Surroundings around;
  for (const world::Position& place : places) {
    scene_.look_around(place, around);
    for (std::uint32_t k = 0; k < scene_.stations(); ++k)
      if (scene_.first_los(scene_.link_model().blocking_height_m(Scene::link(around, k))) > 0) ++blocked;
  }
  const std::size_t links = places.size() * scene_.stations();
  return links == 0 ? 0.0 : static_cast<double>(blocked) / static_cast<double>(links);
}

}  // namespace aloft::radio
