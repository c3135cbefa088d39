#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/agents/site_map.hpp"
#include "python/src/observation.hpp"

namespace aloft::python {

/// The observation of a flight, from what the UAV reports and what its operator knows. Environments and agents on the
/// bus see the same.
class Observer {
 public:
  explicit Observer(const Layout& layout) : layout_(layout), reports_(layout.reports()) {}

  /// A flight begins: what was observed before is forgotten.
  void begin(const agents::FlightInfo& flight);
  /// The sites that are known, and whether they have sector antennas.
  void survey(std::vector<world::Site> sites, bool sectors);
  /// The route ahead: [i] is where the result of step + 1 + i is read.
  void plan(std::uint32_t step, std::vector<world::Position> route);
  /// Reports come in the order of their steps.
  void note(const agents::Observation& report, world::Position uav);

  /// Writes Layout::size() values.
  void write(std::span<float> to) const;
  [[nodiscard]] const Layout& layout() const noexcept { return layout_; }

 private:
  Layout layout_;
  agents::FlightInfo flight_;
  std::vector<float> reports_;  // newest first
  bool empty_ = true;
  std::uint32_t step_ = 0;
  world::Position uav_;
  std::vector<world::Site> sites_;
  bool sectors_ = false;
  std::vector<world::Position> route_;
  std::uint32_t route_step_ = 0;
};

}  // namespace aloft::python
