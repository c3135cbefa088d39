#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tools/importer/scatter.hpp"

namespace aloft::importer {

/// How far samples count.
struct Reach {
  double radius_m = 25.0;        ///< over the ground
  double height_radius_m = 5.0;  ///< up and down
};

struct CellValue {
  std::int32_t cell = 0;
  double value = 0.0;
};

/// What is known of a place.
struct CellValues {
  std::vector<CellValue> by_cell;  ///< of every cell with a sample in reach; empty: there is none
  std::int32_t nearest_cell = 0;   ///< of the nearest sample, the first of equals

  [[nodiscard]] std::optional<double> of(std::int32_t cell) const;
};

/// Values where none was measured: per cell, the mean of its samples in reach, weighted by the inverse square of their
/// distance in space, which counts as 1 m at least.
class ScatterField {
 public:
  /// The samples must outlive the field.
  ScatterField(const std::vector<Sample>& samples, Reach reach);

  /// As if the samples of which `skip` is true had not been taken.
  [[nodiscard]] CellValues at(
      world::Position position, double height_m,
      const std::function<bool(const Sample&)>& skip = [](const Sample&) { return false; }) const;

 private:
  /// A square of the ground, as wide as the radius.
  struct Square {
    std::int64_t x = 0;
    std::int64_t y = 0;
    auto operator<=>(const Square&) const = default;
  };
  struct Entry {
    Square square;
    const Sample* sample = nullptr;
  };

  [[nodiscard]] Square square_of(world::Position position) const;

  Reach reach_;
  std::vector<Entry> entries_;  // by square, and in one as in the file
};

}  // namespace aloft::importer
