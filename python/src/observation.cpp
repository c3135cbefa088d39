#include "python/src/observation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"

namespace aloft::python {
namespace {

/// Writes values one after the other, within the bounds of their fields.
class Writer {
 public:
  explicit Writer(std::span<float> to) : at_(to.begin()) {}

  void put(const Field& field, double value) {
    // Not a number, which no world gives, would be kept by clamp.
    *at_++ = std::isnan(value) ? field.low : std::clamp(static_cast<float>(value), field.low, field.high);
  }

 private:
  std::span<float>::iterator at_;
};

constexpr std::uint32_t max_history = 1'024;
constexpr std::uint32_t max_sites = 1'024;

}  // namespace

void check_range(std::string_view name, std::uint32_t value, std::uint32_t low, std::uint32_t high) {
  if (value < low || value > high)
    throw InputError("{}: {} is not allowed; use a whole number from {} to {}", name, value, low, high);
}

void check(const Layout& layout) {
  check_range("history", layout.history, 0, max_history);
  check_range("site_map", layout.sites, 0, max_sites);
}

void write_report(const agents::FlightInfo& flight, const agents::Observation& report, std::span<float> to) {
  const auto& [step, height, sinr, neighbours, quality, executed, reward] = report_fields;
  Writer writer(to);
  const double range_m = flight.height_max_m - flight.height_min_m;
  writer.put(step, flight.steps > 0 ? static_cast<double>(report.step) / flight.steps : 0.0);
  writer.put(height, range_m > 0.0 ? (report.height_m - flight.height_min_m) / range_m : 0.0);
  writer.put(sinr, report.serving_sinr_db);
  for (std::uint32_t i = 0; i < agents::max_neighbours; ++i)
    writer.put(neighbours, i < report.neighbour_count ? report.neighbour_sinr_db.at(i) : double{neighbours.low});
  writer.put(quality, agents::in_learning_units(report.qos, flight.qos));
  for (std::uint32_t i = 0; i < executed.values; ++i)
    writer.put(executed, i == static_cast<std::uint32_t>(report.executed) ? 1.0 : 0.0);
  writer.put(reward, agents::in_learning_units(report.reward, flight.qos));
}

void write_site_map(const std::vector<world::Site>& sites, bool sectors, world::Position uav,
                    std::span<const world::Position> route, std::uint32_t count, std::span<float> to) {
  constexpr double km_per_m = 1e-3;
  std::vector<std::pair<double, std::uint32_t>> nearest;
  nearest.reserve(sites.size());
  for (std::uint32_t i = 0; i < sites.size(); ++i)
    nearest.emplace_back(std::hypot(sites[i].position.x_m - uav.x_m, sites[i].position.y_m - uav.y_m), i);
  const auto shown = static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, nearest.size()));
  std::ranges::partial_sort(nearest, nearest.begin() + shown);

  const auto& [east, north, azimuth_cos, azimuth_sin, known] = site_fields;
  Writer writer(to);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::cmp_greater_equal(i, shown)) {
      for (const Field& field : site_fields) writer.put(field, 0.0);
      continue;
    }
    const world::Site& site = sites[nearest[i].second];
    const double azimuth = site.azimuth_deg / 180.0 * std::numbers::pi;
    writer.put(east, km_per_m * (site.position.x_m - uav.x_m));
    writer.put(north, km_per_m * (site.position.y_m - uav.y_m));
    writer.put(azimuth_cos, sectors ? std::cos(azimuth) : 0.0);
    writer.put(azimuth_sin, sectors ? std::sin(azimuth) : 0.0);
    writer.put(known, 1.0);
  }
  writer.put(route_fields[0], route.empty() ? 0.0 : km_per_m * (route.front().x_m - uav.x_m));
  writer.put(route_fields[1], route.empty() ? 0.0 : km_per_m * (route.front().y_m - uav.y_m));
}

}  // namespace aloft::python
