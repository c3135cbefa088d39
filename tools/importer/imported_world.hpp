#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/world/local_projection.hpp"

namespace aloft::importer {

/// Metres between two steps of an imported world: what a step of a measured flight counts as.
inline constexpr double step_spacing_m = 10.0;

/// The heights asked for; the ends default to the multiples of the step that are in the data.
struct HeightOptions {
  std::optional<double> min_m{};
  std::optional<double> max_m{};
  double step_m = 10.0;
};

/// The heights from lowest to highest; `lowest_m` and `highest_m` are those of the data. InputError, beginning with
/// `where`, if there are fewer than two.
[[nodiscard]] std::vector<double> imported_heights(const HeightOptions& options, double lowest_m, double highest_m,
                                                   std::string_view where);

/// Places every 10 m along the way through these corners, the first one included. There must be one corner at least.
/// InputError if there are more than a flight can have.
[[nodiscard]] std::vector<world::Position> places_along(const std::vector<world::Position>& corners,
                                                        std::string_view where);

/// InputError if a measured world cannot have as many values.
void check_size(std::size_t steps, std::size_t heights, std::string_view where);

/// One value of a measured world.
struct ImportedValue {
  double throughput_kbps = 0.0;
  double sinr_db = 0.0;
  std::int32_t serving_cell = 0;
  bool observed = true;
};

/// A measured world that is being made, and which of the optional columns it has.
struct ImportedWorld {
  std::vector<double> height_m;
  std::vector<world::GeoPosition> route;  ///< [step - 1]
  std::vector<ImportedValue> values;      ///< [(step - 1) * heights + level]
  bool has_sinr = false;
  bool has_cells = false;
  bool has_observed = false;
};

/// Its file. Throughput to 0.1 kbit/s, SINR to 0.01 dB, places to 1e-7 degrees.
[[nodiscard]] std::string to_csv(const ImportedWorld& world);

/// A point "A,B". InputError names the option.
[[nodiscard]] world::Position parse_point(std::string_view option, const std::string& text);

}  // namespace aloft::importer
