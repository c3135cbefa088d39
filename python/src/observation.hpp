#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/agents/site_map.hpp"

namespace aloft::python {

/// Adjacent values of an observation. Values beyond the bounds are clipped to them.
struct Field {
  std::string_view name;
  std::uint32_t values = 1;
  float low = 0.0F;
  float high = 1.0F;
};

/// The fields of one report of the UAV, in order.
inline constexpr std::array report_fields{
    Field{"step", 1, 0.0F, 1.0F},                                     // of the steps of the flight
    Field{"height", 1, 0.0F, 1.0F},                                   // of the range of heights
    Field{"sinr_db", 1, -100.0F, 100.0F},                             // of the serving cell
    Field{"neighbours_db", agents::max_neighbours, -100.0F, 100.0F},  // strongest first; absent ones: low
    Field{"quality", 1, 0.0F, 1000.0F},                               // bit/s/Hz or Mbit/s
    Field{"executed", 4, 0.0F, 1.0F},                                 // one of: none, down, hold, up
    Field{"reward", 1, -1000.0F, 1000.0F},                            // bit/s/Hz or Mbit/s
};
/// The fields of one site of the operator's map: its place relative to the UAV, the direction of its sector antenna,
/// and whether there is such a site. In km.
inline constexpr std::array site_fields{
    Field{"east_km", 1, -100.0F, 100.0F}, Field{"north_km", 1, -100.0F, 100.0F}, Field{"azimuth_cos", 1, -1.0F, 1.0F},
    Field{"azimuth_sin", 1, -1.0F, 1.0F}, Field{"known", 1, 0.0F, 1.0F},
};
/// Where the next step leads, relative to the UAV; zero at the route's end.
inline constexpr std::array route_fields{
    Field{"east_km", 1, -100.0F, 100.0F},
    Field{"north_km", 1, -100.0F, 100.0F},
};

[[nodiscard]] constexpr std::size_t values_of(std::span<const Field> fields) {
  std::size_t values = 0;
  for (const Field& field : fields) values += field.values;
  return values;
}

/// The values of an observation: field by field those of the newest report and of earlier ones, then the nearest sites,
/// nearest first, and the route.
struct Layout {
  std::uint32_t history = 0;  ///< earlier reports; before the flight's first one, that one
  std::uint32_t sites = 0;    ///< 0: no site map

  [[nodiscard]] std::size_t reports() const noexcept { return values_of(report_fields) * (1 + std::size_t{history}); }
  [[nodiscard]] std::size_t size() const noexcept {
    return reports() + (sites == 0 ? 0 : sites * values_of(site_fields) + values_of(route_fields));
  }
};

/// InputError with the allowed range.
void check_range(std::string_view name, std::uint32_t value, std::uint32_t low, std::uint32_t high);
/// InputError if an observation would be too large.
void check(const Layout& layout);

/// Writes values_of(report_fields) values.
void write_report(const agents::FlightInfo& flight, const agents::Observation& report, std::span<float> to);

/// Writes the sites that are nearest to `uav`, and the way to the next point of the route, if there is one.
void write_site_map(const std::vector<world::Site>& sites, bool sectors, world::Position uav,
                    std::span<const world::Position> route, std::uint32_t count, std::span<float> to);

}  // namespace aloft::python
