#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parameters.hpp"

namespace aloft::radio {

enum class UavAntenna : std::uint8_t { directional, omnidirectional };
enum class BsAntenna : std::uint8_t { array, sector, tr_38_901 };
enum class FadingKind : std::uint8_t { independent, none, correlated };
enum class ServingSelection : std::uint8_t { best_of_candidates, best_of_all };

/// The radio parameters that every generated world has, whatever its channel model.
[[nodiscard]] const std::vector<ParameterSpec>& radio_parameters();

/// The values of radio_parameters(), with derived constants computed once.
struct RadioModel {
  explicit RadioModel(const Parameters& world);

  UavAntenna uav_antenna;
  BsAntenna bs_antenna;
  FadingKind fading;
  ServingSelection serving_selection;
  std::uint32_t candidates;
  std::uint32_t neighbours;
  double interferer_distance_max_m;  ///< seen by a directional antenna that looks at the horizon

  double link_gain_w;         ///< transmit power x UAV antenna gain x near-field gain: power at 1 m without the base
                              ///< station's antenna
  double noise_w;             ///< thermal noise in the band, with the noise figure
  double bs_downtilt_deg;     ///< of the antenna of TR 38.901
  double efficiency_max;      ///< cap on spectral efficiency, bit/s/Hz; infinity if there is none
  double sector_gain;         ///< gain inside a base station's rectangular sector; outside it is 0
  double fading_correlation;  ///< of the amplitudes at adjacent heights of the table
  double uav_half_beam_cos;   ///< cosine and tangent of half the beamwidth
  double uav_half_beam_tan;
  double bs_half_beam_cos;
};

/// Gain of a rectangular beam of `beamwidth_rad` in both planes, as the paper has it: 4 pi / (w/2)^2 = 16 pi / w^2.
[[nodiscard]] double beam_gain(double beamwidth_rad) noexcept;

/// The paper's near-field gain, which is that of free space at 1 m (Friis): (c / (4 pi f))^2 with c = 3e8 m/s.
[[nodiscard]] double near_field_gain(double carrier_hz) noexcept;

/// Thermal noise at 290 K, -174 dBm/Hz: 10^((-174 + 10 log10(bandwidth) + noise figure) / 10) mW, returned in W.
[[nodiscard]] double noise_power_w(double bandwidth_hz, double noise_figure_db) noexcept;

}  // namespace aloft::radio
