#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/radio/column.hpp"
#include "common/radio/scene.hpp"

namespace aloft::radio {

/// The spectral efficiency to be expected from what an operator knows: the base stations and the radio of the world,
/// but neither the buildings nor the fading.
///
/// With p_c the power of candidate c by the world's own link budget and I_c the sum of its interferers' powers:
/// S_c = p_c / (N + I_c), and E = log2(1 + sum over candidates of S_c). A fading signal without interference counts
/// e^-gamma = 0.56 of its power, because E[ln f] = -gamma for Rayleigh fading (gamma: Euler's constant).
class ExpectedField {
 public:
  /// Line of sight everywhere. `world`: every key of generated_world_parameters(). InputError if there are more sites
  /// than limits::base_stations.
  ExpectedField(const Parameters& world, const std::vector<world::Site>& sites);
  /// Line of sight by the world's channel model among buildings that this seed and trial draw: a city as it could be.
  ExpectedField(const Parameters& world, const std::vector<world::Site>& sites, std::uint64_t seed,
                std::uint32_t trial);

  /// Heights in a column: height_min_m + level * height_step_m.
  [[nodiscard]] std::uint32_t levels() const noexcept { return scene_.heights().size(); }
  /// efficiency[level], bit/s/Hz, with the UAV above `position`. 0 if there are no sites.
  void column(world::Position position, double* efficiency);
  /// The share of the links between these places, at the lowest height, and the sites without line of sight; 0 if there
  /// are none.
  [[nodiscard]] double blocked_share(const std::vector<world::Position>& places) const;

 private:
  Scene scene_;
  ColumnBuilder builder_;
};

}  // namespace aloft::radio
