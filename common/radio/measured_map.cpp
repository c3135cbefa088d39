#include "common/radio/measured_map.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/radio/generated_world.hpp"

namespace aloft::radio {
namespace {

HeightGrid heights_of(const world::MeasuredFlight& flight) {
  return {flight.height_min_m, flight.height_min_m + flight.height_step_m * (flight.heights - 1), flight.height_step_m,
          flight.height_step_m};
}

/// The side of a city that has the route and the base stations in it, as far as a city can be that large. Buildings
/// that an agent draws stand only there.
double window_m(const world::MeasuredSites& known) {
  constexpr double least_m = 3'000.0;  // has the route that the preset's other parameters describe
  constexpr double most_m = 10'000.0;
  double farthest_m = 0.5 * least_m;
  const auto reach = [&](const world::Position& position) {
    farthest_m = std::max({farthest_m, std::fabs(position.x_m), std::fabs(position.y_m)});
  };
  for (const world::Position& position : known.route) reach(position);
  for (const world::Site& site : known.sites) reach(site.position);
  return std::min(2.0 * farthest_m, most_m);
}

class MeasuredMap final : public SignalMap {
 public:
  MeasuredMap(const world::MeasuredFlight& flight, const std::optional<world::MeasuredSites>& known)
      : heights_(heights_of(flight)), route_(flight.steps) {
    if (known) {
      survey_ = measured_survey(flight, *known);
      route_ = known->route;
    }
    for (std::size_t cell = 0; cell < flight.throughput_kbps.size(); ++cell) {
      if (cell % flight.heights == 0) columns_.emplace_back();
      Reading reading;
      reading.qos = flight.throughput_kbps[cell];
      reading.serving_sinr_db = flight.sinr_db[cell];
      reading.serving_cell = flight.serving_cell.empty() ? -1 : flight.serving_cell[cell];
      columns_.back().push_back(reading);
    }
  }

  [[nodiscard]] QosKind qos_kind() const noexcept override { return QosKind::throughput; }
  [[nodiscard]] const HeightGrid& heights() const noexcept override { return heights_; }
  [[nodiscard]] std::uint32_t steps() const noexcept override { return static_cast<std::uint32_t>(columns_.size()); }
  [[nodiscard]] std::uint32_t result_point(std::uint32_t step) const noexcept override { return step - 1; }
  [[nodiscard]] world::Position start() const noexcept override { return route_.front(); }
  [[nodiscard]] world::Position advance(std::uint32_t point, world::Position, std::int32_t) const noexcept override {
    return route_[point];
  }
  [[nodiscard]] bool fixed_route() const noexcept override { return true; }
  [[nodiscard]] const std::vector<Reading>& column(std::uint32_t point, world::Position) override {
    return columns_.at(point);
  }
  [[nodiscard]] const Survey* survey() override { return survey_ ? &*survey_ : nullptr; }

 private:
  HeightGrid heights_;
  std::vector<std::vector<Reading>> columns_;
  std::vector<world::Position> route_;  // [step - 1]
  std::optional<Survey> survey_;
};

}  // namespace

Survey measured_survey(const world::MeasuredFlight& flight, const world::MeasuredSites& known) {
  // At least what a generated world can have, so that its errors name heights that the flight has.
  constexpr double resolution_min_m = 0.1;
  constexpr double mast_min_m = 1.0;
  const HeightGrid heights = heights_of(flight);
  const double mast_m = std::max(std::min(known.antenna_height_m, heights.height_min_m), mast_min_m);
  nlohmann::json radio{{"height_min_m", heights.height_min_m},
                       {"height_max_m", heights.height_max_m},
                       {"height_step_m", heights.height_step_m},
                       {"height_resolution_m", std::max(heights.resolution_m, resolution_min_m)},
                       {"base_station_height_m", mast_m},
                       {"window_m", window_m(known)}};
  if (known.power_w) radio["tx_power_w"] = *known.power_w;
  if (known.sectors) radio["bs_antenna"] = "sector";
  return {resolve_generated_world(radio, ""), {.sites = known.sites}};
}

std::unique_ptr<SignalMap> make_measured_map(const world::MeasuredFlight& flight,
                                             const std::optional<world::MeasuredSites>& known) {
  return std::make_unique<MeasuredMap>(flight, known);
}

}  // namespace aloft::radio
