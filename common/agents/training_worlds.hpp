#pragma once

#include <cstdint>

namespace aloft::agents {

/// The worlds on which 'aloft train pretrained' trains its models.
struct TrainingWorlds {
  // Generated, preset `published`.
  double bs_density_min_per_km2 = 1.0;
  double bs_density_max_per_km2 = 5.0;
  double building_density_per_km2 = 200.0;
  /// Not trained on, but the gains have been measured there, too.
  double building_density_min_per_km2 = 100.0;
  double building_density_max_per_km2 = 300.0;
  // Measured flights are replaced by random throughput fields, with these numbers of heights and steps.
  std::uint32_t measured_levels_min = 8;
  std::uint32_t measured_levels_max = 16;
  std::uint32_t measured_steps_min = 120;
  std::uint32_t measured_steps_max = 200;
};

inline constexpr TrainingWorlds training_worlds{};

}  // namespace aloft::agents
