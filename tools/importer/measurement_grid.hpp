#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/importer/r_workspace.hpp"

namespace aloft::importer {

/// Facts that the workspace does not hold.
struct GridOptions {
  double height_min_m = 20.0;          ///< height of level 1
  double height_step_m = 10.0;         ///< between levels
  std::optional<std::uint32_t> steps;  ///< of one flight; from the lengths of the vectors if not given
};

/// Throughput over (step, height), put together again from flights that each recorded one height per step.
struct MeasurementGrid {
  double height_min_m = 0.0;
  double height_step_m = 0.0;
  std::uint32_t steps = 0;
  std::uint32_t heights = 0;
  std::vector<double> throughput_kbps;  ///< [(step - 1) * heights + level - 1]
  std::vector<bool> observed;           ///< same layout; false: no flight was there, the value is filled in

  std::size_t triples = 0;              ///< (step, height, throughput) triples read
  std::size_t above_known_maximum = 0;  ///< recorded cells above the step's known maximum: expected 0
};

/// Puts every recorded triple of the authors' workspace into its cell. InputError names both places if two values of a
/// cell differ by more than rounding. A cell that no flight recorded gets the value of the nearest recorded step at its
/// height (the earlier one of two), at most the step's known maximum. Messages begin with `where`.
[[nodiscard]] MeasurementGrid rebuild_grid(const NumericVectors& vectors, const GridOptions& options,
                                           std::string_view where);

/// A measured world's file: step,height_m,throughput_kbps,observed. Throughput with 15 significant digits, all that the
/// workspaces hold: the learner's values went through a scaling that left rounding noise in the last bit.
[[nodiscard]] std::string to_csv(const MeasurementGrid& grid);

}  // namespace aloft::importer
