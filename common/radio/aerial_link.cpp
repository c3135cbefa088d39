#include "common/radio/aerial_link.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/radio/approximations.hpp"

namespace aloft::radio {
namespace {

constexpr double speed_of_light_mps = 3.0e8;  // the value of TR 38.901
constexpr double environment_height_m = 1.0;
constexpr double rural_building_height_m = 5.0;
constexpr double rural_street_width_m = 20.0;
constexpr double urban_height_offset_m = 1.5;  // height of a user on the street

/// Elementary functions with the same bits on every machine.
double log10(double x) {
  return natural_log(x) / std::numbers::ln10;
}
double exp(double x) {
  return x < -700.0 ? 0.0 : exp2(x / std::numbers::ln2);
}
double power(double base, double exponent) {
  return exp(exponent * natural_log(base));
}

bool is_aerial(const AerialLink& link) {
  return link.height_m > facts(link.scenario).aerial_above_m;
}

double slant_distance_m(const AerialLink& link) {
  const double rise_m = link.height_m - facts(link.scenario).base_station_height_m;
  return std::max(std::sqrt(link.distance_m * link.distance_m + rise_m * rise_m), 1.0);
}

/// d1/d + exp(-d/p1) (1 - d1/d), and 1 up to d1: the form that all scenarios share but the rural one near the ground.
double falling_probability(double distance_m, double d1_m, double p1_m) {
  if (distance_m <= d1_m) return 1.0;
  const double near = d1_m / distance_m;
  return near + exp(-distance_m / p1_m) * (1.0 - near);
}

double aerial_probability(const AerialLink& link) {
  const double log_height = log10(link.height_m);
  switch (link.scenario) {
    case AerialScenario::uma:
      if (link.height_m > 100.0) return 1.0;
      return falling_probability(link.distance_m, std::max(460.0 * log_height - 700.0, 18.0),
                                 4300.0 * log_height - 3800.0);
    case AerialScenario::umi:
      return falling_probability(link.distance_m, std::max(294.05 * log_height - 432.94, 18.0),
                                 233.98 * log_height - 0.95);
    case AerialScenario::rma:
      break;
  }
  if (link.height_m > 40.0) return 1.0;
  return falling_probability(link.distance_m, std::max(1350.8 * log_height - 1602.0, 18.0),
                             std::max(15021.0 * log_height - 16053.0, 1000.0));
}

double terrestrial_probability(const AerialLink& link) {
  const double distance_m = link.distance_m;
  switch (link.scenario) {
    case AerialScenario::uma: {
      if (distance_m <= 18.0) return 1.0;
      const double tall = link.height_m <= 13.0 ? 0.0 : power((link.height_m - 13.0) / 10.0, 1.5);
      const double hundreds = distance_m / 100.0;
      return falling_probability(distance_m, 18.0, 63.0) *
             (1.0 + tall * 1.25 * hundreds * hundreds * hundreds * exp(-distance_m / 150.0));
    }
    case AerialScenario::umi:
      return falling_probability(distance_m, 18.0, 36.0);
    case AerialScenario::rma:
      break;
  }
  return distance_m <= 10.0 ? 1.0 : exp(-(distance_m - 10.0) / 1000.0);
}

/// 20 log(40 pi fc / 3), the path loss of free space at 1 m as the rural formulas write it.
double free_space_at_1_m_db(const AerialLink& link) {
  return 20.0 * log10(40.0 * std::numbers::pi * link.carrier_ghz / 3.0);
}

double aerial_los_db(const AerialLink& link) {
  const double log_distance = log10(slant_distance_m(link));
  const double log_height = log10(link.height_m);
  const double carrier_db = 20.0 * log10(link.carrier_ghz);
  switch (link.scenario) {
    case AerialScenario::uma:
      return 28.0 + 22.0 * log_distance + carrier_db;
    case AerialScenario::umi:
      return std::max(32.44 + 20.0 * log_distance + carrier_db,
                      30.9 + (22.25 - 0.5 * log_height) * log_distance + carrier_db);
    case AerialScenario::rma:
      break;
  }
  return std::max(23.9 - 1.8 * log_height, 20.0) * log_distance + free_space_at_1_m_db(link);
}

double aerial_nlos_db(const AerialLink& link) {
  const double log_distance = log10(slant_distance_m(link));
  const double log_height = log10(link.height_m);
  switch (link.scenario) {
    case AerialScenario::uma:  // the table has no maximum with line of sight here
      return -17.5 + (46.0 - 7.0 * log_height) * log_distance + free_space_at_1_m_db(link);
    case AerialScenario::umi:
      return std::max(aerial_los_db(link),
                      32.4 + (43.2 - 7.6 * log_height) * log_distance + 20.0 * log10(link.carrier_ghz));
    case AerialScenario::rma:
      break;
  }
  return std::max(aerial_los_db(link), -12.0 + (35.0 - 5.3 * log_height) * log_distance + free_space_at_1_m_db(link));
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
  return 20.0 * log10(slant_m) + free_space_at_1_m_db(link) + std::min(0.03 * grown, 10.0) * log10(slant_m) -
         std::min(0.044 * grown, 14.77) + 0.002 * log10(h) * slant_m;
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

}  // namespace

AerialScenarioFacts facts(AerialScenario scenario) {
  switch (scenario) {
    case AerialScenario::uma:
      return {.base_station_height_m = 25.0, .aerial_above_m = 22.5, .carrier_max_ghz = 100.0, .distance_max_m = 4e3};
    case AerialScenario::umi:
      return {.base_station_height_m = 10.0, .aerial_above_m = 22.5, .carrier_max_ghz = 100.0, .distance_max_m = 4e3};
    case AerialScenario::rma:
      break;
  }
  return {.base_station_height_m = 35.0, .aerial_above_m = 10.0, .carrier_max_ghz = 30.0, .distance_max_m = 10e3};
}

double line_of_sight_probability(const AerialLink& link) {
  return is_aerial(link) ? aerial_probability(link) : terrestrial_probability(link);
}

double path_loss_db(const AerialLink& link, bool line_of_sight) {
  if (is_aerial(link)) return line_of_sight ? aerial_los_db(link) : aerial_nlos_db(link);
  return line_of_sight ? terrestrial_los_db(link) : terrestrial_nlos_db(link);
}

double shadowing_deviation_db(const AerialLink& link, bool line_of_sight) {
  const double h = link.height_m;
  switch (link.scenario) {
    case AerialScenario::uma:
      if (!line_of_sight) return 6.0;
      return is_aerial(link) ? 4.64 * exp(-0.0066 * h) : 4.0;
    case AerialScenario::umi:
      if (!line_of_sight) return is_aerial(link) ? 8.0 : 7.82;
      return is_aerial(link) ? std::max(5.0 * exp(-0.01 * h), 2.0) : 4.0;
    case AerialScenario::rma:
      break;
  }
  if (!line_of_sight) return is_aerial(link) ? 6.0 : 8.0;
  if (is_aerial(link)) return 4.2 * exp(-0.0046 * h);
  return link.distance_m <= breakpoint_m(link) ? 4.0 : 6.0;
}

}  // namespace aloft::radio
