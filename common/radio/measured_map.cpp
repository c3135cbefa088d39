#include "common/radio/measured_map.hpp"

namespace aloft::radio {
namespace {

class MeasuredMap final : public SignalMap {
 public:
  explicit MeasuredMap(const world::MeasuredFlight& flight)
      : heights_{flight.height_min_m, flight.height_min_m + flight.height_step_m * (flight.heights - 1),
                 flight.height_step_m, flight.height_step_m} {
    for (std::size_t cell = 0; cell < flight.throughput_kbps.size(); ++cell) {
      if (cell % flight.heights == 0) columns_.emplace_back();
      Reading reading;
      reading.qos = flight.throughput_kbps[cell];
      reading.serving_sinr_db = flight.sinr_db[cell];
      reading.serving_cell = flight.serving_cell.empty() ? -1 : flight.serving_cell[cell];
      columns_.back().push_back(reading);
    }
  }

  [[nodiscard]] QosKind qos_kind() const noexcept override { return QosKind::throughput; }
  [[nodiscard]] const HeightGrid& heights() const noexcept override { return heights_; }
  [[nodiscard]] std::uint32_t steps() const noexcept override { return static_cast<std::uint32_t>(columns_.size()); }
  [[nodiscard]] std::uint32_t result_point(std::uint32_t step) const noexcept override { return step - 1; }
  [[nodiscard]] world::Position start() const noexcept override { return {}; }
  [[nodiscard]] world::Position advance(std::uint32_t, world::Position, std::int32_t) const noexcept override {
    return {};
  }
  [[nodiscard]] bool fixed_route() const noexcept override { return true; }
  [[nodiscard]] const std::vector<Reading>& column(std::uint32_t point, world::Position) override {
    return columns_.at(point);
  }

 private:
  HeightGrid heights_;
  std::vector<std::vector<Reading>> columns_;
};

}  // namespace

std::unique_ptr<SignalMap> make_measured_map(const world::MeasuredFlight& flight) {
  return std::make_unique<MeasuredMap>(flight);
}

}  // namespace aloft::radio
