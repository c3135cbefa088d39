#include "common/flight/testing/synthetic_map.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/random.hpp"
#include "common/radio/generated_world.hpp"

namespace aloft::flight {

using radio::QosKind;

namespace {

constexpr std::int32_t cells = 7;

}  // namespace

SyntheticMap::SyntheticMap(QosKind kind, const radio::HeightGrid& grid, std::vector<std::vector<double>> qos)
    : kind_(kind), grid_(grid), qos_(std::move(qos)), columns_(qos_.size()) {
  for (std::uint32_t point = 0; point < qos_.size(); ++point) {
    if (qos_[point].size() != grid_.size()) throw std::logic_error("a synthetic map needs one value per height");
    for (std::uint32_t i = 0; i < grid_.size(); ++i) columns_[point].push_back(made_of(point, i));
  }
}

SyntheticMap SyntheticMap::random(QosKind kind, std::uint32_t steps, std::uint32_t levels, std::uint64_t seed) {
  const radio::HeightGrid grid{40.0, 40.0 + 10.0 * (levels - 1), 10.0, 10.0};
  const double scale = kind == QosKind::throughput ? 4000.0 : 1.0;  // kbit/s or bit/s/Hz
  RandomStream stream(seed, 0, "synthetic map");
  std::vector<std::vector<double>> qos(kind == QosKind::throughput ? steps : steps + 1);
  std::vector<double> hills(levels, 8.0);
  for (auto& column : qos) {
    for (double& hill : hills) {
      hill = std::fmin(20.0, std::fmax(0.5, hill + 2.0 * stream.normal()));
      column.push_back(scale * hill);
    }
  }
  return {kind, grid, std::move(qos)};
}

radio::Reading SyntheticMap::made_of(std::uint32_t point, std::uint32_t index) const {
  radio::Reading reading;
  reading.qos = qos_[point][index];
  const double spectral_efficiency = kind_ == QosKind::throughput ? reading.qos / 10'000.0 : reading.qos;
  reading.serving_sinr_db = 10.0 * std::log10(std::exp2(spectral_efficiency) - 1.0 + 1e-9);
  reading.serving_cell = static_cast<std::int32_t>(reading.qos) % cells;
  reading.neighbour_count = kind_ == QosKind::throughput ? 0 : radio::max_neighbours;
  for (std::uint32_t i = 0; i < reading.neighbour_count; ++i)
    reading.neighbour_sinr_db.at(i) = reading.serving_sinr_db - 3.0 * (i + 1);
  return reading;
}

void SyntheticMap::set_qos(std::uint32_t point, std::uint32_t index, double value) {
  qos_.at(point).at(index) = value;
  columns_[point][index] = made_of(point, index);
}

std::uint32_t SyntheticMap::steps() const noexcept {
  const auto points = static_cast<std::uint32_t>(qos_.size());
  return kind_ == QosKind::throughput ? points : points - 1;
}

std::uint32_t SyntheticMap::result_point(std::uint32_t step) const noexcept {
  return kind_ == QosKind::throughput ? step - 1 : step;
}

world::Position SyntheticMap::advance(std::uint32_t point, world::Position from,
                                      std::int32_t serving_cell) const noexcept {
  const double side_m = serving_cell % 2 == 0 ? -10.0 : 10.0;
  return {10.0 * point, follow_serving_cell_ ? from.y_m + side_m : 0.0};
}

const radio::Survey* SyntheticMap::survey() {
  if (survey_ && survey_->map.route_points == route_points_) return &*survey_;
  survey_ = {radio::resolve_generated_world({{"height_min_m", grid_.height_min_m},
                                             {"height_max_m", grid_.height_max_m},
                                             {"height_step_m", grid_.height_step_m},
                                             {"height_resolution_m", grid_.resolution_m}},
                                            "world"),
             {}};
  survey_->map.route_points = route_points_;
  RandomStream stream(1, 0, "synthetic sites");
  for (std::int32_t cell = 0; cell < 12; ++cell)
    survey_->map.sites.push_back({cell, {stream.uniform(-500.0, 900.0), stream.uniform(-500.0, 500.0)}, 0.0});
  return &*survey_;
}

const std::vector<radio::Reading>& SyntheticMap::read(std::uint32_t point, world::Position position) const {
  // Beside the straight line the UAV reads the next point's column, so that tests can see where it is.
  const bool beside = std::fabs(position.y_m) > 5.0;
  return columns_.at(beside ? (point + 1) % columns_.size() : point);
}

const std::vector<radio::Reading>& SyntheticMap::column(std::uint32_t point, world::Position position) {
  ++columns_read_;
  return read(point, position);
}

radio::Reading SyntheticMap::reading(std::uint32_t point, world::Position position, std::uint32_t height) {
  return read(point, position).at(height);
}

void SyntheticMap::scan(std::uint32_t point, world::Position position, std::uint32_t height,
                        std::span<const std::int32_t> /*also*/, radio::CellScan& into) {
  const radio::Reading strongest = reading(point, position, height);
  into.neighbours = strongest.neighbour_count;
  into.cells.clear();
  for (int i = 0; i < cells; ++i)
    into.cells.push_back({(strongest.serving_cell + i) % cells, -80.0 - 3.0 * i, strongest.serving_sinr_db - 3.0 * i,
                          strongest.qos / (1.0 + i)});
}

}  // namespace aloft::flight
