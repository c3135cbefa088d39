#include "common/agents/site_belief.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/radio/approximations.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using namespace aloft::agents;
using aloft::radio::ReportLikelihood;
using nlohmann::json;

namespace {

constexpr SiteBelief::Settings settings{.particles = 8, .reports = 30, .moves = 60};

/// A city, its wrong map, and the reports of a flight that climbs and wanders.
struct Survey {
  Survey(const json& given, std::uint32_t trial)
      : world(radio::resolve_generated_world(given, "world")),
        city(world::generate_city(world, 7, trial)),
        signal(radio::make_generated_map(world, city, 7, trial)),
        map{world, signal->survey()->map},
        belief(std::make_unique<SiteBelief>(map, settings, RandomStream(7, trial, "belief"))) {}

  void fly(std::uint32_t steps) {
    for (; steps > 0 && step < signal->steps(); --steps) {
      ++step;
      level = std::clamp(level + static_cast<int>(walk.uniform_index(3)) - (step < 15 ? 0 : 1), 0, 20);
      place = signal->advance(signal->result_point(step), signal->start(), -1);
      const auto& column = signal->column(signal->result_point(step), place);
      const radio::Reading& reading = column[static_cast<std::size_t>(level) * 10];
      ReportLikelihood::Report report{
          place, 40.0 + 10.0 * level, static_cast<std::uint32_t>(reading.serving_cell), 1, {}};
      report.sinr[0] = radio::power_of_ten(reading.serving_sinr_db / 10.0);
      for (std::uint32_t i = 0; i < reading.neighbour_count; ++i)
        report.sinr[report.sinrs++] = radio::power_of_ten(reading.neighbour_sinr_db.at(i) / 10.0);
      belief->learn(report);
    }
  }

  /// Mean distance between believed and true positions of the stations near the UAV, m.
  [[nodiscard]] double error_m() const {
    double sum_m = 0.0;
    int near = 0;
    for (std::size_t k = 0; k < city.base_stations.size(); ++k) {
      const world::Position truth = city.base_stations[k];
      const auto distance_m = [&](world::Position to) { return std::hypot(to.x_m - truth.x_m, to.y_m - truth.y_m); };
      if (distance_m(place) > 400.0) continue;
      ++near;
      for (const SiteBelief::Particle& particle : belief->particles())
        sum_m += particle.weight * distance_m(particle.stations[k]);
    }
    return sum_m / std::max(near, 1);
  }

  Parameters world;
  world::City city;
  std::unique_ptr<radio::SignalMap> signal;
  SiteSurvey map;
  std::unique_ptr<SiteBelief> belief;
  RandomStream walk{7, 0, "walk"};
  std::uint32_t step = 0;
  int level = 0;
  world::Position place;
};

}  // namespace

TEST_CASE("at first the maps that could be are as far from the stated one as it says") {
  const Survey survey({{"site_map_error_m", 50}, {"bs_density_per_km2", 25}}, 0);
  double squares_m2 = 0.0;
  for (const SiteBelief::Particle& particle : survey.belief->particles()) {
    CHECK(particle.weight == 1.0 / 8);
    for (std::size_t k = 0; k < particle.stations.size(); ++k) {
      const world::Position stated = survey.map.map.sites[k].position;
      squares_m2 +=
          std::pow(particle.stations[k].x_m - stated.x_m, 2) + std::pow(particle.stations[k].y_m - stated.y_m, 2);
    }
  }
  const double numbers = 2.0 * 8.0 * static_cast<double>(survey.map.map.sites.size());  // about 3,600
  CHECK(std::sqrt(squares_m2 / numbers) == Approx(50).epsilon(0.05));
}

TEST_CASE("reports bring the maps that could be nearer to the truth") {
  // Drawn anew, a position is sqrt(pi) * 50 m = 88.6 m from the truth in the mean.
  double before_m = 0.0;
  double after_m = 0.0;
  constexpr int trials = 6;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    Survey survey({{"site_map_error_m", 50}, {"bs_density_per_km2", 5}}, trial);
    survey.fly(40);
    Survey fresh({{"site_map_error_m", 50}, {"bs_density_per_km2", 5}}, trial);
    fresh.place = survey.place;
    before_m += fresh.error_m() / trials;
    after_m += survey.error_m() / trials;
    double weights = 0.0;
    for (const SiteBelief::Particle& particle : survey.belief->particles()) weights += particle.weight;
    CHECK(weights == Approx(1.0));
  }
  INFO("before " << before_m << " m, after " << after_m << " m");
  CHECK(before_m > 65.0);
  CHECK(after_m < 45.0);
}

TEST_CASE("a restored belief goes on with the same bits") {
  Survey survey({{"site_map_error_m", 25}}, 1);
  survey.fly(33);  // more reports than are kept
  const Parameters none({}, json::object(), "none");
  StateWriter writer("belief", none);
  survey.belief->save(writer);
  Survey copy({{"site_map_error_m", 25}}, 1);
  copy.belief->restore(StateReader(writer.bytes(), "belief", none));
  copy.walk = survey.walk;
  copy.step = survey.step;
  copy.level = survey.level;
  survey.fly(5);
  copy.fly(5);
  for (std::size_t i = 0; i < settings.particles; ++i) {
    CHECK(survey.belief->particles()[i].weight == copy.belief->particles()[i].weight);
    for (std::size_t k = 0; k < survey.map.map.sites.size(); ++k)
      CHECK(survey.belief->particles()[i].stations[k].x_m == copy.belief->particles()[i].stations[k].x_m);
  }
}
