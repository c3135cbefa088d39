#include "common/radio/aerial_link.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "common/base/widest_vectors.hpp"
#include "common/radio/aerial_formulas.hpp"
#include "common/radio/approximations.hpp"

namespace aloft::radio {
namespace {

constexpr double speed_of_light_mps = 3.0e8;  // the value of TR 38.901
constexpr double environment_height_m = 1.0;
constexpr double rural_building_height_m = 5.0;
constexpr double rural_street_width_m = 20.0;
constexpr double urban_height_offset_m = 1.5;  // height of a user on the street

double power(double base, double exponent) {
  return exp_of(exponent * natural_log(base));
}

bool is_aerial(const AerialLink& link) {
  return link.height_m > facts(link.scenario).aerial_above_m;
}

double slant_distance_m(const AerialLink& link) {
  const double rise_m = link.height_m - facts(link.scenario).base_station_height_m;
  return std::max(std::sqrt(link.distance_m * link.distance_m + rise_m * rise_m), 1.0);
}

AerialLink at_height(AerialLink link, double height_m) {
  link.height_m = height_m;
  return link;
}

/// A quantity above a height at which the tables jump: `at_jump` of the link at that height, `above` by the table.
template <class AtJump>
double blended(const AerialLink& link, double jump_m, AtJump&& at_jump, double above) {
  const double risen_m = link.height_m - jump_m;
  if (risen_m >= link.blend_m) return above;
  const double at = at_jump(at_height(link, jump_m));
  return at + risen_m / link.blend_m * (above - at);
}

/// Table B-1 up to certain_above_m.
double aerial_probability(const AerialLink& link) {
  switch (link.scenario) {
    case AerialScenario::uma:
      return aerial_los_probability<AerialScenario::uma>(link.distance_m, link.height_m);
    case AerialScenario::umi:
      return aerial_los_probability<AerialScenario::umi>(link.distance_m, link.height_m);
    case AerialScenario::rma:
      break;
  }
  return aerial_los_probability<AerialScenario::rma>(link.distance_m, link.height_m);
}

double terrestrial_probability(const AerialLink& link) {
  const double distance_m = link.distance_m;
  switch (link.scenario) {
    case AerialScenario::uma: {
      if (distance_m <= 18.0) return 1.0;
      const double tall = link.height_m <= 13.0 ? 0.0 : power((link.height_m - 13.0) / 10.0, 1.5);
      const double hundreds = distance_m / 100.0;
      return falling_probability(distance_m, 18.0, 63.0) *
             (1.0 + tall * 1.25 * hundreds * hundreds * hundreds * exp_of(-distance_m / 150.0));
    }
    case AerialScenario::umi:
      return falling_probability(distance_m, 18.0, 36.0);
    case AerialScenario::rma:
      break;
  }
  return distance_m <= 10.0 ? 1.0 : exp_of(-(distance_m - 10.0) / 1000.0);
}

template <AerialScenario scenario>
double aerial_db(const AerialLink& link, bool line_of_sight) {
  const double log_slant = log10(slant_distance_m(link));
  const double log_height = log10(link.height_m);
  const CarrierLoss carrier = carrier_loss(link.carrier_ghz);
  return line_of_sight ? aerial_path_loss_db<scenario, true>(carrier, log_slant, log_height)
                       : aerial_path_loss_db<scenario, false>(carrier, log_slant, log_height);
}

double aerial_db(const AerialLink& link, bool line_of_sight) {
  switch (link.scenario) {
    case AerialScenario::uma:
      return aerial_db<AerialScenario::uma>(link, line_of_sight);
    case AerialScenario::umi:
      return aerial_db<AerialScenario::umi>(link, line_of_sight);
    case AerialScenario::rma:
      break;
  }
  return aerial_db<AerialScenario::rma>(link, line_of_sight);
}

/// Horizontal distance beyond which the terrestrial path loss with line of sight grows faster.
double breakpoint_m(const AerialLink& link) {
  const double per_wavelength = link.carrier_ghz * 1e9 / speed_of_light_mps;
  const double base_m = facts(link.scenario).base_station_height_m;
  if (link.scenario == AerialScenario::rma) return 2.0 * std::numbers::pi * base_m * link.height_m * per_wavelength;
  return 4.0 * (base_m - environment_height_m) * (link.height_m - environment_height_m) * per_wavelength;
}

double rural_before_breakpoint_db(const AerialLink& link, double slant_m) {
  const double h = rural_building_height_m;
  const double grown = power(h, 1.72);
  return 20.0 * log10(slant_m) + carrier_loss(link.carrier_ghz).free_space_at_1_m_db +
         std::min(0.03 * grown, 10.0) * log10(slant_m) - std::min(0.044 * grown, 14.77) + 0.002 * log10(h) * slant_m;
}

double terrestrial_los_db(const AerialLink& link) {
  const double slant_m = slant_distance_m(link);
  const double at_breakpoint_m = breakpoint_m(link);
  const bool beyond = link.distance_m > at_breakpoint_m;
  if (link.scenario == AerialScenario::rma) {
    if (!beyond) return rural_before_breakpoint_db(link, slant_m);
    return rural_before_breakpoint_db(link, at_breakpoint_m) + 40.0 * log10(slant_m / at_breakpoint_m);
  }
  const bool macro = link.scenario == AerialScenario::uma;
  const double at_1_m_db = (macro ? 28.0 : 32.4) + 20.0 * log10(link.carrier_ghz);
  if (!beyond) return at_1_m_db + (macro ? 22.0 : 21.0) * log10(slant_m);
  const double rise_m = link.height_m - facts(link.scenario).base_station_height_m;
  return at_1_m_db + 40.0 * log10(slant_m) -
         (macro ? 9.0 : 9.5) * log10(at_breakpoint_m * at_breakpoint_m + rise_m * rise_m);
}

double rural_nlos_db(const AerialLink& link) {
  const double h = rural_building_height_m;
  const double base_m = facts(link.scenario).base_station_height_m;
  const double user = log10(11.75 * link.height_m);
  return 161.04 - 7.1 * log10(rural_street_width_m) + 7.5 * log10(h) -
         (24.37 - 3.7 * (h / base_m) * (h / base_m)) * log10(base_m) +
         (43.42 - 3.1 * log10(base_m)) * (log10(slant_distance_m(link)) - 3.0) + 20.0 * log10(link.carrier_ghz) -
         (3.2 * user * user - 4.97);
}

double terrestrial_nlos_db(const AerialLink& link) {
  const double log_distance = log10(slant_distance_m(link));
  const double log_carrier = log10(link.carrier_ghz);
  const double raised_m = link.height_m - urban_height_offset_m;
  double behind_db = 0.0;
  switch (link.scenario) {
    case AerialScenario::uma:
      behind_db = 13.54 + 39.08 * log_distance + 20.0 * log_carrier - 0.6 * raised_m;
      break;
    case AerialScenario::umi:
      behind_db = 22.4 + 35.3 * log_distance + 21.3 * log_carrier - 0.3 * raised_m;
      break;
    case AerialScenario::rma:
      behind_db = rural_nlos_db(link);
      break;
  }
  return std::max(terrestrial_los_db(link), behind_db);
}

/// The first of so many equal sections of a range of heights at whose end the probability reaches a level.
constexpr std::size_t sections = 16;

template <AerialScenario scenario>
[[gnu::always_inline]] inline void section_loop(double distance_m, double low_m, double section_m,
                                                double* probability) {
  for (std::size_t i = 0; i < sections; ++i)
    probability[i] = aerial_los_probability<scenario>(distance_m, low_m + section_m * static_cast<double>(i + 1));
}

/// Where the probability, continuous and less than `level` at `low_m`, reaches it, at `high_m` at the latest.
template <AerialScenario scenario>
double first_reached_m(double distance_m, double low_m, double high_m, double level) {
  std::array<double, sections> probability{};
  while (high_m - low_m > lowest_height_tolerance_m) {
    const double section_m = (high_m - low_m) / sections;
    run_vectorised<section_loop<scenario>>(distance_m, low_m, section_m, probability.data());
    std::size_t i = 0;
    while (i + 1 < sections && probability.at(i) < level) ++i;
    if (i + 1 < sections) high_m = low_m + section_m * static_cast<double>(i + 1);
    low_m += section_m * static_cast<double>(i);
  }
  return high_m;
}

double first_reached_m(const AerialLink& link, double low_m, double high_m, double level) {
  switch (link.scenario) {
    case AerialScenario::uma:
      return first_reached_m<AerialScenario::uma>(link.distance_m, low_m, high_m, level);
    case AerialScenario::umi:
      return first_reached_m<AerialScenario::umi>(link.distance_m, low_m, high_m, level);
    case AerialScenario::rma:
      break;
  }
  return first_reached_m<AerialScenario::rma>(link.distance_m, low_m, high_m, level);
}

/// Table B-3, and at low heights Table 7.4.1-1.
double table_deviation_db(const AerialLink& link, bool line_of_sight) {
  const bool aerial = is_aerial(link);
  switch (link.scenario) {
    case AerialScenario::uma:
      if (!line_of_sight) return 6.0;
      return aerial ? aerial_shadowing_los_db<AerialScenario::uma>(link.height_m) : 4.0;
    case AerialScenario::umi:
      if (!line_of_sight) return aerial ? 8.0 : 7.82;
      return aerial ? aerial_shadowing_los_db<AerialScenario::umi>(link.height_m) : 4.0;
    case AerialScenario::rma:
      break;
  }
  if (!line_of_sight) return aerial ? 6.0 : 8.0;
  if (aerial) return aerial_shadowing_los_db<AerialScenario::rma>(link.height_m);
  return link.distance_m <= breakpoint_m(link) ? 4.0 : 6.0;
}

/// The lowest height from `low_m` on at which the probability, which has no jumps, is at least `level`.
double first_without_jumps_m(const AerialLink& link, double low_m, double level) {
  const auto reached = [&](double height_m) { return line_of_sight_probability(at_height(link, height_m)) >= level; };
  if (reached(low_m)) return low_m;
  double high_m = aerial_height_max_m;
  if (!reached(high_m)) return std::numeric_limits<double>::infinity();
  while (high_m - low_m > lowest_height_tolerance_m) {
    const double middle_m = 0.5 * (low_m + high_m);
    (reached(middle_m) ? high_m : low_m) = middle_m;
  }
  return high_m;
}

}  // namespace

double line_of_sight_probability(const AerialLink& link) {
  const AerialScenarioFacts limits = facts(link.scenario);
  if (link.height_m > limits.certain_above_m) return blended(link, limits.certain_above_m, aerial_probability, 1.0);
  if (!is_aerial(link)) return terrestrial_probability(link);
  return blended(link, limits.aerial_above_m, terrestrial_probability, aerial_probability(link));
}

double lowest_height_m(const AerialLink& link, double level) {
  const auto reached = [&](double height_m) {
    return line_of_sight_probability({link.scenario, link.carrier_ghz, link.distance_m, height_m}) >= level;
  };
  // The probability is continuous up to each of these heights, and jumps above. Below the first, for the heights of
  // base stations, it does not depend on the height.
  const AerialScenarioFacts limits = facts(link.scenario);
  double low_m = limits.base_station_height_m;
  if (link.blend_m > 0.0) return first_without_jumps_m(link, low_m, level);
  const bool never_certain = limits.certain_above_m == aerial_height_max_m;
  if (never_certain && !reached(limits.certain_above_m)) return std::numeric_limits<double>::infinity();
  if (low_m <= limits.aerial_above_m) {
    if (reached(low_m)) return low_m;
    low_m = std::nextafter(limits.aerial_above_m, std::numeric_limits<double>::infinity());
  }
  if (reached(low_m)) return low_m;
  if (never_certain || reached(limits.certain_above_m))
    return first_reached_m(link, low_m, limits.certain_above_m, level);
  return std::nextafter(limits.certain_above_m, std::numeric_limits<double>::infinity());
}

double path_loss_db(const AerialLink& link, bool line_of_sight) {
  const auto terrestrial_db = [line_of_sight](const AerialLink& low) {
    return line_of_sight ? terrestrial_los_db(low) : terrestrial_nlos_db(low);
  };
  if (!is_aerial(link)) return terrestrial_db(link);
  return blended(link, facts(link.scenario).aerial_above_m, terrestrial_db, aerial_db(link, line_of_sight));
}

double shadowing_deviation_db(const AerialLink& link, bool line_of_sight) {
  const auto table_db = [line_of_sight](const AerialLink& at) { return table_deviation_db(at, line_of_sight); };
  if (!is_aerial(link)) return table_db(link);
  return blended(link, facts(link.scenario).aerial_above_m, table_db, table_db(link));
}

}  // namespace aloft::radio
