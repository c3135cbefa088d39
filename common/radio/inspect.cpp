#include "common/radio/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "common/base/error.hpp"
#include "common/radio/fading.hpp"
#include "common/radio/scene.hpp"
#include "common/world/route.hpp"

namespace aloft::radio {
namespace {

using Json = nlohmann::json;

std::uint32_t height_index(const HeightGrid& heights, double height_m) {
  const double index = std::round((height_m - heights.height_min_m) / heights.resolution_m);
  if (!(index >= 0.0 && index < heights.size()) ||
      std::fabs(heights.height_m(static_cast<std::uint32_t>(index)) - height_m) > 1e-6)
    throw InputError("height {} m is not in the table; use {} to {} m in steps of {} m", height_m, heights.height_min_m,
                     heights.height_max_m, heights.resolution_m);
  return static_cast<std::uint32_t>(index);
}

/// Explains one place and height, in the same steps as ColumnBuilder.
class Explainer {
 public:
  Explainer(const Scene& scene, const Fading& fading, std::uint32_t point, world::Position position,
            std::uint32_t height)
      : scene_(scene), fading_(fading), point_(point), position_(position), height_(height) {
    scene.look_around(position, around_);
  }

  Explanation explain() {
    Explanation result;
    result.point = point_;
    result.position = position_;
    result.height_m = scene_.heights().height_m(height_);
    result.noise_w = scene_.model().noise_w;
    for (std::uint32_t k = 0; k < scene_.stations(); ++k) stations_.push_back(station(k));
    result.stations = stations_;

    std::vector<std::uint32_t> order(scene_.stations());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::greater(), [this](std::uint32_t k) { return stations_[k].received_power_w; });
    for (std::uint32_t rank = 0; rank < scene_.reported_stations(); ++rank)
      result.candidates.push_back(candidate(order[rank], rank < scene_.serving_candidates()));

    const CandidateExplanation* serving = &result.candidates.front();
    for (const CandidateExplanation& other : result.candidates)
      if (other.may_serve && other.sinr > serving->sinr) serving = &other;
    result.serving_cell = serving->station;
    result.serving_sinr_db = serving->sinr_db;
    result.spectral_efficiency = spectral_efficiency(serving->sinr, scene_.model().efficiency_max);
    return result;
  }

 private:
  [[nodiscard]] StationExplanation station(std::uint32_t k) const {
    const Link& link = around_.links[k];
    StationExplanation result;
    result.station = k;
    result.distance_m = link.distance_m;
    result.azimuth_deg = std::atan2(link.dy_m, link.dx_m) * (180.0 / std::numbers::pi);
    result.blocking_height_m = scene_.link_model().blocking_height_m(Scene::link(around_, k));
    result.line_of_sight = height_ >= scene_.first_los(result.blocking_height_m);
    const double height_m = scene_.heights().height_m(height_);
    const double rise_m = scene_.rise_m(height_);
    result.shadowing_db = scene_.shadowing_db(Scene::link(around_, k), result.line_of_sight, height_m);
    scene_.received_power_row(around_, k, std::span(&height_m, 1), std::span(&rise_m, 1), result.line_of_sight ? 0 : 1,
                              &result.received_power_w);
    return result;
  }

  CandidateExplanation candidate(std::uint32_t c, bool may_serve) {
    CandidateExplanation result;
    result.station = c;
    result.may_serve = may_serve;
    result.received_power_w = stations_[c].received_power_w;
    result.fading = fading(c, c);
    const BeamLimits limits = beam_limits(scene_.model(), around_.links[c].distance_m, scene_.rise_m(height_));
    const bool directional = scene_.model().uav_antenna == UavAntenna::directional;
    for (std::uint32_t k = 0; k < scene_.stations(); ++k) {
      if (!scene_.can_interfere(around_, c, k) || (directional && !limits.contain(around_.links[k].distance_m)))
        continue;
      const double fading_factor = fading(c, k);
      const double interference_w = stations_[k].received_power_w * fading_factor;
      result.interferers.push_back({k, stations_[k].received_power_w, fading_factor, interference_w});
      result.interference_w += interference_w;
    }
    result.sinr = result.received_power_w * result.fading / (scene_.model().noise_w + result.interference_w);
    result.sinr_db = decibel(result.sinr);
    return result;
  }

  double fading(std::uint32_t c, std::uint32_t k) {
    const std::uint32_t block = height_ / Fading::lanes;
    fading_.want(point_, c, k, std::span(&block, 1));
    return fading_.take(point_)[height_ % Fading::lanes];
  }

  const Scene& scene_;
  Fading fading_;
  std::uint32_t point_;
  world::Position position_;
  std::uint32_t height_;
  Surroundings around_;
  std::vector<StationExplanation> stations_;
};

}  // namespace

Explanation explain(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial,
                    std::uint32_t point, double height_m, std::optional<world::Position> position) {
  const world::Route route(world, city);
  if (point > route.steps()) throw InputError("route point {} does not exist; use 0 to {}", point, route.steps());
  const Scene scene(world, city, seed, trial);
  const std::uint32_t height = height_index(scene.heights(), height_m);
  const world::Position place = position.value_or(route.advance(point, {0.0, 0.0}, -1));
  return Explainer(scene, Fading(scene.model(), seed, trial), point, place, height).explain();
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StationExplanation, station, distance_m, azimuth_deg, blocking_height_m,
                                   line_of_sight, shadowing_db, received_power_w)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(InterfererExplanation, station, received_power_w, fading, interference_w)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CandidateExplanation, station, may_serve, received_power_w, fading, interferers,
                                   interference_w, sinr, sinr_db)

Json to_json(const Explanation& explanation) {
  return {{"point", explanation.point},
          {"x_m", explanation.position.x_m},
          {"y_m", explanation.position.y_m},
          {"height_m", explanation.height_m},
          {"noise_w", explanation.noise_w},
          {"stations", explanation.stations},
          {"candidates", explanation.candidates},
          {"serving_cell", explanation.serving_cell},
          {"serving_sinr_db", explanation.serving_sinr_db},
          {"spectral_efficiency", explanation.spectral_efficiency}};
}

std::string to_text(const Explanation& explanation) {
  std::string text = fmt::format("Route point {} at x = {:g} m, y = {:g} m, height {:g} m\n\n", explanation.point,
                                 explanation.position.x_m, explanation.position.y_m, explanation.height_m);
  text += "Base stations (power before fading; no line of sight below the blocking height)\n";
  text += "  station  distance_m  azimuth_deg  blocking_height_m  line of sight  shadowing_db  power_w\n";
  for (const StationExplanation& s : explanation.stations)
    text += fmt::format("  {:7}  {:10.1f}  {:11.1f}  {:17.1f}  {:13}  {:12.1f}  {:.4e}\n", s.station, s.distance_m,
                        s.azimuth_deg, s.blocking_height_m, s.line_of_sight ? "yes" : "no", s.shadowing_db,
                        s.received_power_w);
  for (const CandidateExplanation& c : explanation.candidates) {
    text += fmt::format("\n{} {}: {:.4e} W x fading {:.4f} = {:.4e} W\n", c.may_serve ? "Candidate" : "Neighbour",
                        c.station, c.received_power_w, c.fading, c.received_power_w * c.fading);
    for (const InterfererExplanation& i : c.interferers)
      text += fmt::format("  interferer {}: {:.4e} W x fading {:.4f} = {:.4e} W\n", i.station, i.received_power_w,
                          i.fading, i.interference_w);
    text += fmt::format("  interference {:.4e} W + noise {:.4e} W: SINR {:.2f} dB\n", c.interference_w,
                        explanation.noise_w, c.sinr_db);
  }
  text += fmt::format("\nServing cell {}: SINR {:.2f} dB, spectral efficiency {:.4f} bit/s/Hz\n",
                      explanation.serving_cell, explanation.serving_sinr_db, explanation.spectral_efficiency);
  return text;
}

}  // namespace aloft::radio
