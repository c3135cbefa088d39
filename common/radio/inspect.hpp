#pragma once

#include <cstdint>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::radio {

/// One base station as it is received, before fading.
struct StationExplanation {
  std::uint32_t station = 0;
  double distance_m = 0.0;         ///< horizontal
  double azimuth_deg = 0.0;        ///< seen from the UAV, counterclockwise from +x, in (-180, 180]
  double blocking_height_m = 0.0;  ///< no line of sight below this height
  bool line_of_sight = false;
  double shadowing_db = 0.0;  ///< loss beyond the mean
  double received_power_w = 0.0;
};

struct InterfererExplanation {
  std::uint32_t station = 0;
  double received_power_w = 0.0;
  double fading = 0.0;          ///< power factor
  double interference_w = 0.0;  ///< received power x fading
};

/// A base station whose SINR the UAV measures.
struct CandidateExplanation {
  std::uint32_t station = 0;
  bool may_serve = false;  ///< false: only a neighbour
  double received_power_w = 0.0;
  double fading = 0.0;
  std::vector<InterfererExplanation> interferers;
  double interference_w = 0.0;
  double sinr = 0.0;  ///< linear
  double sinr_db = 0.0;
};

/// The intermediate values of one entry of a generated world's table.
struct Explanation {
  std::uint32_t point = 0;
  world::Position position;
  double height_m = 0.0;
  double noise_w = 0.0;
  std::vector<StationExplanation> stations;
  std::vector<CandidateExplanation> candidates;  ///< descending received power
  std::uint32_t serving_cell = 0;
  double serving_sinr_db = 0.0;
  double spectral_efficiency = 0.0;  ///< bit/s/Hz
};

/// Explains route point `point` at `height_m`, by the same functions as the table: the SINRs have the same bits.
/// `position`: where the UAV is; by default on the route (rule `serving`: on the line y = 0). Throws InputError if
/// there is no such point, or the height is not one of the table's.
[[nodiscard]] Explanation explain(const Parameters& world, const world::City& city, std::uint64_t seed,
                                  std::uint32_t trial, std::uint32_t point, double height_m,
                                  std::optional<world::Position> position = std::nullopt);

[[nodiscard]] nlohmann::json to_json(const Explanation& explanation);
/// Text for a terminal.
[[nodiscard]] std::string to_text(const Explanation& explanation);

/// Base stations, building grid and heights, and the route (null if it depends on the flight).
[[nodiscard]] nlohmann::json world_to_json(const Parameters& world, const world::City& city);
/// The same as rows kind,index,x_m,y_m,height_m with kind base_station, building or route_point (without a height).
void write_world_csv(std::ostream& out, const Parameters& world, const world::City& city);

/// Quality, SINR and serving cell over route point x height. Throws InputError if the route depends on the flight.
void write_table_json(std::ostream& out, SignalMap& map);
void write_table_csv(std::ostream& out, SignalMap& map);

}  // namespace aloft::radio
