#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/radio/signal_map.hpp"

namespace aloft::flight {

/// A signal map with given qualities, for tests of flights and agents without a radio model.
///
/// Like a generated world, point 0 is never scored (result_point(j) = j); with QosKind::throughput it is like a
/// measured flight (result_point(j) = j - 1). Readings have a SINR that follows from the quality and 5 neighbours below
/// it. There are seven cells; the one of the reading is the strongest, and each of the others 3 dB weaker than the
/// next.
class SyntheticMap final : public radio::SignalMap {
 public:
  /// `qos[point][i]`: at height grid.height_min_m + i * grid.resolution_m; all rows have grid.size() values.
  SyntheticMap(radio::QosKind kind, const radio::HeightGrid& grid, std::vector<std::vector<double>> qos);

  /// Smooth random hills over heights and points, a pure function of the seed: 10 m steps from 40 m.
  static SyntheticMap random(radio::QosKind kind, std::uint32_t steps, std::uint32_t levels, std::uint64_t seed);

  /// Makes the route depend on the flight: at each point the UAV swerves by 10 m, to one side if the serving cell is
  /// even, to the other if it is odd.
  void follow_serving_cell() noexcept { follow_serving_cell_ = true; }
  /// Makes the operator tell only so many points of the route ahead at a time.
  void tell_route_in_parts(std::uint32_t points) { route_points_ = points; }
  [[nodiscard]] const std::vector<std::vector<double>>& qos() const noexcept { return qos_; }
  void set_qos(std::uint32_t point, std::uint32_t index, double value);

  [[nodiscard]] radio::QosKind qos_kind() const noexcept override { return kind_; }
  [[nodiscard]] const radio::HeightGrid& heights() const noexcept override { return grid_; }
  [[nodiscard]] std::uint32_t steps() const noexcept override;
  [[nodiscard]] std::uint32_t result_point(std::uint32_t step) const noexcept override;
  [[nodiscard]] world::Position start() const noexcept override { return {0.0, 0.0}; }
  [[nodiscard]] world::Position advance(std::uint32_t point, world::Position from,
                                        std::int32_t serving_cell) const noexcept override;
  [[nodiscard]] bool fixed_route() const noexcept override { return !follow_serving_cell_; }
  /// Twelve base stations near the route, whatever the qualities are.
  [[nodiscard]] const radio::Survey* survey() override;
  [[nodiscard]] const std::vector<radio::Reading>& column(std::uint32_t point, world::Position position) override;
  [[nodiscard]] radio::Reading reading(std::uint32_t point, world::Position position, std::uint32_t height) override;
  void scan(std::uint32_t point, world::Position position, std::uint32_t height, std::span<const std::int32_t> also,
            radio::CellScan& into) override;
  /// How many columns have been asked for.
  [[nodiscard]] std::uint32_t columns_read() const noexcept { return columns_read_; }

 private:
  [[nodiscard]] radio::Reading made_of(std::uint32_t point, std::uint32_t index) const;
  [[nodiscard]] const std::vector<radio::Reading>& read(std::uint32_t point, world::Position position) const;

  radio::QosKind kind_;
  radio::HeightGrid grid_;
  std::vector<std::vector<double>> qos_;
  std::vector<std::vector<radio::Reading>> columns_;
  std::uint32_t columns_read_ = 0;
  std::uint32_t route_points_ = 0;
  std::optional<radio::Survey> survey_;
  bool follow_serving_cell_ = false;
};

}  // namespace aloft::flight
