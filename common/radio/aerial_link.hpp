#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "common/base/parameters.hpp"

namespace aloft::radio {

/// The environments of 3GPP TR 36.777 V15.0.0, Annex B: urban macro, urban micro and rural macro cells with aerial
/// users.
enum class AerialScenario : std::uint8_t { uma, umi, rma };

inline constexpr std::array<Choice<AerialScenario>, 3> aerial_scenarios{
    {{"uma-av", AerialScenario::uma}, {"umi-av", AerialScenario::umi}, {"rma-av", AerialScenario::rma}}};

/// What the tables say of a scenario.
struct AerialScenarioFacts {
  double base_station_height_m = 0.0;
  double aerial_above_m = 0.0;  ///< up to this height of the UAV TR 38.901 applies, above it TR 36.777
  double carrier_max_ghz = 0.0;
  double distance_max_m = 0.0;  ///< horizontal; the formulas go on, but the standard does not vouch for them
};

inline constexpr double aerial_carrier_min_ghz = 0.7;
inline constexpr double aerial_height_min_m = 1.5;
inline constexpr double aerial_height_max_m = 300.0;

[[nodiscard]] AerialScenarioFacts facts(AerialScenario scenario);

/// A UAV at `height_m` and a base station of the scenario's height, `distance_m` apart on the ground. Valid for heights
/// from aerial_height_min_m to aerial_height_max_m, carriers from aerial_carrier_min_ghz to carrier_max_ghz and
/// distances from 0; slant distances below 1 m count as 1 m.
struct AerialLink {
  AerialScenario scenario = AerialScenario::uma;
  double carrier_ghz = 2.0;
  double distance_m = 0.0;
  double height_m = 0.0;
};

/// Probability of line of sight: TR 36.777 Table B-1, at low heights TR 38.901 Table 7.4.2-1.
[[nodiscard]] double line_of_sight_probability(const AerialLink& link);
/// Path loss, dB: TR 36.777 Table B-2, at low heights TR 38.901 Table 7.4.1-1 with the effective environment height of
/// 1 m (urban), buildings of 5 m and streets of 20 m (rural).
[[nodiscard]] double path_loss_db(const AerialLink& link, bool line_of_sight);
/// Standard deviation of shadowing, dB: TR 36.777 Table B-3, at low heights TR 38.901 Table 7.4.1-1.
[[nodiscard]] double shadowing_deviation_db(const AerialLink& link, bool line_of_sight);

}  // namespace aloft::radio
