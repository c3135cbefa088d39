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
  double aerial_above_m = 0.0;   ///< up to this height of the UAV TR 38.901 applies, above it TR 36.777
  double certain_above_m = 0.0;  ///< above this height there is always line of sight (umi: the greatest height)
  double carrier_max_ghz = 0.0;
  double distance_max_m = 0.0;  ///< horizontal; the formulas go on, but the standard does not vouch for them
};

inline constexpr double aerial_carrier_min_ghz = 0.7;
inline constexpr double aerial_height_min_m = 1.5;
inline constexpr double aerial_height_max_m = 300.0;
inline constexpr double aerial_blend_max_m = 20.0;

[[nodiscard]] constexpr AerialScenarioFacts facts(AerialScenario scenario) {
  switch (scenario) {
    case AerialScenario::uma:
      return {.base_station_height_m = 25.0,
              .aerial_above_m = 22.5,
              .certain_above_m = 100.0,
              .carrier_max_ghz = 100.0,
              .distance_max_m = 4e3};
    case AerialScenario::umi:
      return {.base_station_height_m = 10.0,
              .aerial_above_m = 22.5,
              .certain_above_m = aerial_height_max_m,
              .carrier_max_ghz = 100.0,
              .distance_max_m = 4e3};
    case AerialScenario::rma:
      break;
  }
  return {.base_station_height_m = 35.0,
          .aerial_above_m = 10.0,
          .certain_above_m = 40.0,
          .carrier_max_ghz = 30.0,
          .distance_max_m = 10e3};
}

/// A UAV at `height_m` and a base station of the scenario's height, `distance_m` apart on the ground. Valid for heights
/// from aerial_height_min_m to aerial_height_max_m, carriers from aerial_carrier_min_ghz to carrier_max_ghz and
/// distances from 0; slant distances below 1 m count as 1 m.
///
/// The tables jump above aerial_above_m and above certain_above_m. With blend_m they do not: over so many metres above
/// such a height h, a quantity is (1 - w) of that at h and w of that of the table, w rising from 0 to 1. Probabilities
/// and, above aerial_above_m, path losses and deviations in dB.
struct AerialLink {
  AerialScenario scenario = AerialScenario::uma;
  double carrier_ghz = 2.0;
  double distance_m = 0.0;
  double height_m = 0.0;
  double blend_m = 0.0;  ///< to aerial_blend_max_m, so that the two do not meet
};

/// Probability of line of sight: TR 36.777 Table B-1, at low heights TR 38.901 Table 7.4.2-1.
[[nodiscard]] double line_of_sight_probability(const AerialLink& link);
inline constexpr double lowest_height_tolerance_m = 1e-6;
/// The lowest height, m, from the base station's upwards, at which the probability of line of sight is at least
/// `level`: exact where the probability jumps, else at most lowest_height_tolerance_m too high. Infinity if it is less
/// up to aerial_height_max_m. The probability never falls with the height, so it is at least `level` from there on.
/// Ignores link.height_m.
[[nodiscard]] double lowest_height_m(const AerialLink& link, double level);
/// Path loss, dB: TR 36.777 Table B-2, at low heights TR 38.901 Table 7.4.1-1 with the effective environment height of
/// 1 m (urban), buildings of 5 m and streets of 20 m (rural).
[[nodiscard]] double path_loss_db(const AerialLink& link, bool line_of_sight);
/// Standard deviation of shadowing, dB: TR 36.777 Table B-3, at low heights TR 38.901 Table 7.4.1-1.
[[nodiscard]] double shadowing_deviation_db(const AerialLink& link, bool line_of_sight);

}  // namespace aloft::radio
