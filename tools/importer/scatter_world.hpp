#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "tools/importer/imported_world.hpp"
#include "tools/importer/link_quality.hpp"
#include "tools/importer/scatter.hpp"
#include "tools/importer/scatter_field.hpp"

namespace aloft::importer {

struct ScatterOptions {
  Reach reach;
  double hole_max_m = 100.0;  ///< how far along the route a value may be taken from
  double apart_s = 2.0;       ///< samples nearer in time do not count as held out from each other
  HeightOptions heights;
  std::vector<world::Position> route;  ///< corners, x: latitude, y: longitude; empty: where the lowest samples are
  RadioOptions radio;
};

/// The measured world of these samples. At every step and height, per cell, ScatterField's value. RSRP: the serving
/// cell is the strongest, and its SINR that over noise and the others; else the cell of the nearest sample serves.
/// Where no sample is in reach, the values of the nearest step at that height, the earlier of two, with `observed`
/// false. InputError, beginning with `where`, if that is farther than hole_max_m, or if there is none.
[[nodiscard]] ImportedWorld scatter_world(const Scatter& scatter, const ScatterOptions& options,
                                          std::string_view where);

/// How well samples are predicted by the others, in the unit of the quantity.
struct HeldOutError {
  std::int32_t cell = 0;
  std::size_t samples = 0;
  std::size_t predicted = 0;  ///< of them; for the rest nothing is in reach
  double mean = 0.0;          ///< predicted minus measured; 0 if nothing is predicted
  double root_mean_square = 0.0;
};

/// For all samples, and for each cell: every sample in turn is predicted from those that were taken apart_s or more
/// before or after it (without times: from all others).
struct HeldOut {
  HeldOutError all;
  std::vector<HeldOutError> by_cell;
};

[[nodiscard]] HeldOut held_out_error(const Scatter& scatter, const ScatterOptions& options);

}  // namespace aloft::importer
