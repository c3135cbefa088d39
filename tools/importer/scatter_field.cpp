#include "tools/importer/scatter_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace aloft::importer {
namespace {

constexpr double least_distance_m = 1.0;

struct WeightedMean {
  double weight = 0.0;
  double sum = 0.0;
};

}  // namespace

std::optional<double> CellValues::of(std::int32_t cell) const {
  const auto found = std::ranges::find(by_cell, cell, &CellValue::cell);
  return found == by_cell.end() ? std::nullopt : std::optional(found->value);
}

ScatterField::ScatterField(const std::vector<Sample>& samples, Reach reach) : reach_(reach) {
  for (const Sample& sample : samples) entries_.push_back({square_of(sample.position), &sample});
  std::ranges::stable_sort(entries_, {}, &Entry::square);
}

ScatterField::Square ScatterField::square_of(world::Position position) const {
  return {static_cast<std::int64_t>(std::floor(position.x_m / reach_.radius_m)),
          static_cast<std::int64_t>(std::floor(position.y_m / reach_.radius_m))};
}

CellValues ScatterField::at(world::Position position, double height_m,
                            const std::function<bool(const Sample&)>& skip) const {
  std::map<std::int32_t, WeightedMean> means;
  CellValues found;
  const Sample* nearest = nullptr;
  double nearest_m = std::numeric_limits<double>::infinity();
  const Square middle = square_of(position);
  for (std::int64_t x = middle.x - 1; x <= middle.x + 1; ++x) {
    const auto first = std::ranges::lower_bound(entries_, Square{x, middle.y - 1}, {}, &Entry::square);
    const auto last = std::ranges::upper_bound(first, entries_.end(), Square{x, middle.y + 1}, {}, &Entry::square);
    for (auto entry = first; entry != last; ++entry) {
      const Sample& sample = *entry->sample;
      const double ground_m = std::hypot(sample.position.x_m - position.x_m, sample.position.y_m - position.y_m);
      const double rise_m = std::fabs(sample.height_m - height_m);
      if (ground_m > reach_.radius_m || rise_m > reach_.height_radius_m || skip(sample)) continue;
      const double distance_m = std::hypot(ground_m, rise_m);
      const double counted_m = std::max(distance_m, least_distance_m);
      WeightedMean& mean = means[sample.cell];
      mean.weight += 1.0 / (counted_m * counted_m);
      mean.sum += sample.value / (counted_m * counted_m);
      if (distance_m < nearest_m || (distance_m == nearest_m && &sample < nearest)) {
        nearest = &sample;
        nearest_m = distance_m;
      }
    }
  }
  for (const auto& [cell, mean] : means) found.by_cell.push_back({cell, mean.sum / mean.weight});
  if (nearest != nullptr) found.nearest_cell = nearest->cell;
  return found;
}

}  // namespace aloft::importer
