#include "common/radio/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/random.hpp"
#include "common/radio/height_rows.hpp"
#include "common/world/city.hpp"

namespace aloft::radio {
namespace {

std::vector<double> draw_azimuths(const Parameters& world, const world::City& city, std::uint64_t seed,
                                  std::uint32_t trial) {
  std::vector<double> azimuths;
  const BsAntenna antenna = RadioModel(world).bs_antenna;
  if (antenna == BsAntenna::array) return azimuths;
  if (world::cells_per_site(world) == 3) {  // 30, 150 and 270 degrees
    constexpr std::array<double, 3> half_turns{1.0 / 6.0, 5.0 / 6.0, -0.5};
    for (std::size_t k = 0; k < city.base_stations.size(); ++k) azimuths.push_back(half_turns.at(k % 3));
    return azimuths;
  }
  RandomStream stream(seed, trial, "sector azimuth");
  for (std::size_t k = 0; k < city.base_stations.size(); ++k) azimuths.push_back(stream.uniform(-1.0, 1.0));
  return azimuths;
}

}  // namespace

HeightGrid height_grid(const Parameters& world) {
  return {world.number("height_min_m"), world.number("height_max_m"), world.number("height_step_m"),
          world.number("height_resolution_m")};
}

Scene::Scene(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial)
    : Scene(world, city, seed, trial, height_grid(world), draw_azimuths(world, city, seed, trial)) {
  for (const std::size_t los : {0U, 1U}) {
    const Shadowing shadowing = link_model_->shadowing(los == 1);
    if (shadowing.deviation_max_db > 0.0)
      shadowing_.at(los).emplace(seed, trial, los == 1 ? "shadowing in line of sight" : "shadowing",
                                 (stations() + cells_per_site_ - 1) / cells_per_site_,
                                 shadowing.correlation_distance_m);
  }
}

Scene::Scene(const Parameters& world, world::City city, std::uint64_t seed, std::uint32_t trial,
             const HeightGrid& heights, std::vector<double> sector_azimuths)
    : city_(std::move(city)),
      cells_per_site_(world::cells_per_site(world)),
      model_(world),
      link_model_(link_model_type(world.text("propagation")).make(world, city_, seed, trial)),
      heights_(heights),
      sector_azimuths_(std::move(sector_azimuths)) {
  if (city_.base_stations.size() > limits::base_stations)
    throw InputError("the city has {} base stations; at most {} are possible", city_.base_stations.size(),
                     limits::base_stations);
  for (const double s : sector_azimuths_) {
    const double sine_of_size = cos_pi(0.5 - std::fabs(s));
    sector_boresight_.push_back({cos_pi(s), s < 0.0 ? -sine_of_size : sine_of_size});
  }
}

void Scene::look_around(world::Position position, Surroundings& into) const {
  into.position = position;
  into.links.resize(stations());
  into.sector_covers.assign(stations(), 1);
  into.horizontal_loss_db.assign(stations(), 0.0);
  for (std::uint32_t k = 0; k < stations(); ++k) look_towards(city_.base_stations[k], k, into);
}

void Scene::look_towards(world::Position station, std::uint32_t k, Surroundings& around) const {
  Link& link = around.links[k];
  link.dx_m = station.x_m - around.position.x_m;
  link.dy_m = station.y_m - around.position.y_m;
  link.distance_m = std::sqrt(link.dx_m * link.dx_m + link.dy_m * link.dy_m);
  if (model_.bs_antenna == BsAntenna::tr_38_901)
    around.horizontal_loss_db[k] = azimuth_loss_db(link, sector_boresight_[k]);
  if (model_.bs_antenna != BsAntenna::sector) return;
  around.sector_covers[k] = radio::sector_covers(model_, link, sector_boresight_[k]) ? 1 : 0;
}

std::uint32_t Scene::first_los(double blocking_height_m) const noexcept {
  const double above = std::ceil((blocking_height_m - heights_.height_min_m) / heights_.resolution_m);
  auto index = static_cast<std::uint32_t>(std::clamp(above, 0.0, static_cast<double>(heights_.size())));
  // The division can round to a neighbouring index; these comparisons correct it.
  if (index > 0 && heights_.height_m(index - 1) >= blocking_height_m) --index;
  if (index < heights_.size() && heights_.height_m(index) < blocking_height_m) ++index;
  return index;
}

void Scene::shadow(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m, double* gain) const {
  const auto& field = shadowing_.at(line_of_sight ? 1 : 0);
  if (!field || height_m.empty()) return;
  const double deviations = field->at(link.uav, link.station / cells_per_site_);
  std::array<double, 256> deviation_db;
  for (std::size_t first = 0; first < height_m.size(); first += deviation_db.size()) {
    const auto part = height_m.subspan(first, std::min(deviation_db.size(), height_m.size() - first));
    link_model_->shadowing_row(link, line_of_sight, part, deviation_db.data());
    shadow_row(deviations, std::span(deviation_db).first(part.size()), gain + first);
  }
}

double Scene::gain_bound(const LinkPlace& link, bool line_of_sight) const {
  const double mean = link_model_->gain_bound(link, line_of_sight);
  const auto& field = shadowing_.at(line_of_sight ? 1 : 0);
  if (!field) return mean;
  const double deviations = std::min(0.0, field->at(link.uav, link.station / cells_per_site_));
  return mean * power_of_ten(-0.1 * deviations * link_model_->shadowing(line_of_sight).deviation_max_db);
}

double Scene::shadowing_db(const LinkPlace& link, bool line_of_sight, double height_m) const {
  const auto& field = shadowing_.at(line_of_sight ? 1 : 0);
  if (!field) return 0.0;
  double deviation_db = 0.0;
  link_model_->shadowing_row(link, line_of_sight, std::span(&height_m, 1), &deviation_db);
  return field->at(link.uav, link.station / cells_per_site_) * deviation_db;
}

void Scene::received_power_row(const Surroundings& around, std::uint32_t k, std::span<const double> height_m,
                               std::span<const double> rise_m, std::size_t first_los, double* power_w) const {
  const LinkPlace place = link(around, k);
  const auto gains = [&](bool line_of_sight, std::span<const double> part_m, double* gain) {
    link_model_->mean_gain_row(place, line_of_sight, part_m, gain);
    shadow(place, line_of_sight, part_m, gain);
  };
  if (first_los > 0) gains(false, height_m.first(first_los), power_w);
  gains(true, height_m.subspan(first_los), power_w + first_los);
  radio::received_power_row(model_, place.distance_m, around.horizontal_loss_db[k], rise_m, power_w);
}

std::uint32_t Scene::reported_stations() const noexcept {
  if (model_.serving_selection == ServingSelection::best_of_all) return stations();
  return std::min(stations(), std::max(model_.candidates, model_.neighbours + 1));
}

std::uint32_t Scene::serving_candidates() const noexcept {
  if (model_.serving_selection == ServingSelection::best_of_all) return stations();
  return std::min(stations(), model_.candidates);
}

}  // namespace aloft::radio
