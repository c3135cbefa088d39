#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/world/local_projection.hpp"

namespace aloft::importer {

/// What the samples measure.
enum class Quantity { rsrp_dbm, rsrq_db, sinr_db, throughput_kbps };

/// Its unit, as people write it.
[[nodiscard]] const char* unit_of(Quantity quantity);

/// The names of a file's columns. Columns that are not named here are ignored.
struct ScatterColumns {
  std::string latitude = "latitude";
  std::string longitude = "longitude";
  std::string altitude = "altitude";
  std::string value;  ///< of the quantity
  Quantity quantity = Quantity::sinr_db;
  std::string cell;            ///< empty: none
  std::string time;            ///< empty: none
  double kbps_per_unit = 1.0;  ///< of throughputs
  double ground_m = 0.0;       ///< altitude of the ground: heights count from it
};

/// One row of the file.
struct Sample {
  world::Position position;  ///< from the middle of the samples
  double height_m = 0.0;
  double value = 0.0;
  std::int32_t cell = 0;
  double time_s = 0.0;
};

struct Scatter {
  Quantity quantity = Quantity::sinr_db;
  bool has_cells = false;
  bool has_times = false;
  world::GeoPosition middle;
  std::vector<Sample> samples;  ///< as in the file
};

/// Reads samples that lie anywhere. InputError "name:line:column: reason".
[[nodiscard]] Scatter parse_scatter(std::string_view csv, std::string_view name, const ScatterColumns& columns);

}  // namespace aloft::importer
