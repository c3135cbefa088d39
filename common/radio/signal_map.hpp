#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/radio/reading.hpp"
#include "common/world/world.hpp"

namespace aloft::radio {

/// The heights of a world: index i is height_min_m + i * resolution_m.
struct HeightGrid {
  double height_min_m = 0.0;
  double height_max_m = 0.0;
  double height_step_m = 0.0;  ///< d: one action
  double resolution_m = 0.0;   ///< of the table; divides height_step_m

  [[nodiscard]] std::uint32_t size() const noexcept {
    return static_cast<std::uint32_t>(std::lround((height_max_m - height_min_m) / resolution_m)) + 1;
  }
  [[nodiscard]] std::uint32_t indices_per_step() const noexcept {
    return static_cast<std::uint32_t>(std::lround(height_step_m / resolution_m));
  }
  [[nodiscard]] double height_m(std::uint32_t index) const noexcept { return height_min_m + resolution_m * index; }
};

/// What an operator knows before the flight.
struct Survey {
  Parameters radio;  ///< of the world: every key of generated_world_parameters()
  world::SiteMap map;
};

/// The cells that a UAV can tell apart at one place, strongest power first.
struct CellScan {
  std::vector<CellReading> cells;
  std::uint32_t neighbours = 0;  ///< how many the UAV reports besides its serving cell
};

/// All that a UAV can measure in one trial: readings over (route point, lateral position, height). Every agent of the
/// trial reads the same map. Nothing is computed before it is asked for; columns are kept. Not thread-safe.
class SignalMap {
 public:
  virtual ~SignalMap() = default;

  [[nodiscard]] virtual QosKind qos_kind() const noexcept = 0;
  [[nodiscard]] virtual const HeightGrid& heights() const noexcept = 0;
  /// Actions in a flight. The result of step j is read at route point result_point(j).
  [[nodiscard]] virtual std::uint32_t steps() const noexcept = 0;
  /// 0-based. Generated: result_point(j) = j (point 0 is never scored). Measured: j - 1.
  [[nodiscard]] virtual std::uint32_t result_point(std::uint32_t step) const noexcept = 0;

  /// Where the route starts, before the first action.
  [[nodiscard]] virtual world::Position start() const noexcept = 0;
  /// Where a UAV that was at `from`, served by base station `serving_cell`, is at the next route point. With the
  /// `nearest` route rule and in measured flights this depends on `point` alone.
  [[nodiscard]] virtual world::Position advance(std::uint32_t point, world::Position from,
                                                std::int32_t serving_cell) const noexcept = 0;
  /// True if advance() depends on the point alone, so that the whole route is known beforehand.
  [[nodiscard]] virtual bool fixed_route() const noexcept = 0;

  /// The readings at every height of heights() at this place. The reference stays valid as long as the map.
  [[nodiscard]] virtual const std::vector<Reading>& column(std::uint32_t point, world::Position position) = 0;

  /// The reading at heights()[height] alone: column()[height] to the bit, for much less than the whole column takes.
  [[nodiscard]] virtual Reading reading(std::uint32_t point, world::Position position, std::uint32_t height) {
    return column(point, position)[height];
  }

  /// Cell by cell: those that can serve or are reported, and after them those of `also` that are not among these. The
  /// best SINR of the candidates is that of reading(), to the bit. std::logic_error if the map does not know single
  /// cells.
  virtual void scan(std::uint32_t point, world::Position position, std::uint32_t height,
                    std::span<const std::int32_t> also, CellScan& into);

  /// Null if nobody knows where the base stations are. Valid as long as the map.
  [[nodiscard]] virtual const Survey* survey() { return nullptr; }

  /// Computes every column now, if the whole route is known beforehand; else does nothing.
  void prepare();
};

}  // namespace aloft::radio
