#pragma once

#include <cmath>
#include <numbers>

#include "common/radio/approximations.hpp"
#include "common/radio/radio_model.hpp"
#include "common/world/world.hpp"

/// The formulas of one link at one height, as in the published simulator. The table and its explanation call the same
/// functions, so they agree to the bit. Heights are relative to the base station antennas: rise_m = h - 30 m.
namespace aloft::radio {

/// Ground geometry of one link, seen from the UAV.
struct Link {
  double dx_m = 0.0;  ///< from the UAV to the base station
  double dy_m = 0.0;
  double distance_m = 0.0;  ///< horizontal
};

/// Gain of the 8-element vertical array at the elevation whose sine is s: g(s) = (1/8) [sin(4 pi s) / sin(pi s / 2)]^2,
/// limit 8 at 0. With x = pi s / 2: sin(8x) / sin(x) = 8 cos x cos 2x cos 4x; s^2 suffices for it.
[[gnu::always_inline]] inline double array_gain(double sin2_elevation) noexcept {
  const double cos_x = cos_half_pi_root(sin2_elevation);
  const double cos_2x = std::fma(2.0 * cos_x, cos_x, -1.0);
  const double cos_4x = std::fma(2.0 * cos_2x, cos_2x, -1.0);
  const double product = cos_x * cos_2x * cos_4x;
  return 8.0 * (product * product);
}

/// 3GPP TR 38.901 Table 7.3-1: the radiation of an antenna element with 8 dBi, and 65 degrees of beamwidth in both
/// planes; no direction has more than 30 dB less.
inline constexpr double element_peak_db = 8.0;
inline constexpr double element_beamwidth_deg = 65.0;
inline constexpr double element_loss_max_db = 30.0;

/// min(12 (angle / 65 degrees)^2, 30) dB: the loss at this angle off the beam in one plane.
[[gnu::always_inline]] inline double element_loss_db(double angle_deg) noexcept {
  const double beamwidths = angle_deg / element_beamwidth_deg;
  const double loss_db = 12.0 * (beamwidths * beamwidths);
  return loss_db < element_loss_max_db ? loss_db : element_loss_max_db;
}

/// The horizontal loss towards the UAV of an antenna with this boresight, a unit vector. 0 right above it.
[[gnu::always_inline]] inline double azimuth_loss_db(const Link& link, world::Position boresight) noexcept {
  const double along_m = -(link.dx_m * boresight.x_m + link.dy_m * boresight.y_m);
  const double across_m = std::fabs(link.dx_m * boresight.y_m - link.dy_m * boresight.x_m);
  const double acute_deg = arctangent(across_m, std::fabs(along_m)) * (180.0 / std::numbers::pi);
  return element_loss_db(along_m < 0.0 ? 180.0 - acute_deg : acute_deg);
}

/// Gain of the element: 8 dBi - min(vertical + horizontal loss, 30 dB), its beam tilted down.
[[gnu::always_inline]] inline double element_gain(const RadioModel& model, double distance_m, double rise_m,
                                                  double horizontal_loss_db) noexcept {
  const double elevation_deg = arctangent(rise_m, distance_m) * (180.0 / std::numbers::pi);
  const double loss_db = element_loss_db(elevation_deg + model.bs_downtilt_deg) + horizontal_loss_db;
  return power_of_ten(0.1 * (element_peak_db - (loss_db < element_loss_max_db ? loss_db : element_loss_max_db)));
}

/// Mean received power, W, before fading: p = P G K g(s) x `gain`, the gain of the channel model. A base station with a
/// rectangular sector steers it at the UAV; `horizontal_loss_db` is that of the antenna of TR 38.901, which is not
/// steered. Distances below 1 m count as 1 m.
template <BsAntenna antenna>
[[gnu::always_inline]] inline double received_power_w(const RadioModel& model, double distance_m, double rise_m,
                                                      double horizontal_loss_db, double gain) noexcept {
  if constexpr (antenna == BsAntenna::tr_38_901)
    return model.link_gain_w * element_gain(model, distance_m, rise_m, horizontal_loss_db) * gain;
  const double sum_m2 = distance_m * distance_m + rise_m * rise_m;
  const double slant2_m2 = sum_m2 < 1.0 ? 1.0 : sum_m2;
  const double antenna_gain =
      antenna == BsAntenna::array ? array_gain(rise_m * rise_m * (1.0 / slant2_m2)) : model.sector_gain;
  return model.link_gain_w * antenna_gain * gain;
}

/// Horizontal distances of the base stations that the UAV's beam covers while it points at one at `distance_m`.
struct BeamLimits {
  [[nodiscard, gnu::always_inline]] inline bool contain(double distance_m) const noexcept {
    return distance_m >= nearest_m && distance_m <= farthest_m;
  }
  double nearest_m = 0.0;
  double farthest_m = 0.0;
};

/// With theta = atan2(rise, distance) and half beamwidth v: nearest = rise / tan(theta + v) if theta < pi/2 - v, else
/// 0; farthest = rise / tan(theta - v) if v < theta < pi/2 - v, `interferer_distance_max_m` if theta <= v, else rise
/// (the published simulator's choice). The code expands the tangents of sums: rise >= 0, t = tan v.
[[gnu::always_inline]] inline BeamLimits beam_limits(const RadioModel& model, double distance_m,
                                                     double rise_m) noexcept {
  const double t = model.uav_half_beam_tan;
  const double below = distance_m - rise_m * t;  // > 0: theta < pi/2 - v
  const double above = rise_m - distance_m * t;  // > 0: theta > v
  const double nearest_m = rise_m * below / (rise_m + distance_m * t);
  const double farthest_m = rise_m * (distance_m + rise_m * t) / above;
  return {below > 0.0 ? nearest_m : 0.0,
          above <= 0.0 ? model.interferer_distance_max_m : (below > 0.0 ? farthest_m : rise_m)};
}

/// The margin for rounding that pruning adds to the channel model's bound of the gain.
inline constexpr double bound_rounding = 1.0 + 1e-9;

/// Upper bound, W, of the power received from a base station whose channel gain is at most `gain_bound`.
[[nodiscard]] inline double power_bound_w(const RadioModel& model, double gain_bound) noexcept {
  constexpr double array_peak = 8.0;
  double antenna_gain = model.sector_gain;
  if (model.bs_antenna == BsAntenna::array) antenna_gain = array_peak;
  if (model.bs_antenna == BsAntenna::tr_38_901) antenna_gain = power_of_ten(0.1 * element_peak_db);
  return bound_rounding * model.link_gain_w * antenna_gain * gain_bound;
}

/// Whether the azimuths of two base stations, seen from the UAV, differ by less than half the UAV's beamwidth.
[[nodiscard, gnu::always_inline]] inline bool same_azimuth(const RadioModel& model, const Link& a,
                                                           const Link& b) noexcept {
  return a.dx_m * b.dx_m + a.dy_m * b.dy_m > model.uav_half_beam_cos * (a.distance_m * b.distance_m);
}

/// Whether a base station's sector, whose boresight is this unit vector, covers the UAV.
[[gnu::always_inline]] inline bool sector_covers(const RadioModel& model, const Link& link,
                                                 world::Position boresight) noexcept {
  const double along_m = -(link.dx_m * boresight.x_m + link.dy_m * boresight.y_m);
  return along_m > model.bs_half_beam_cos * link.distance_m;
}

/// Spectral efficiency in bit/s/Hz: log2(1 + SINR), Shannon, but no more than `most`.
[[gnu::always_inline]] inline double spectral_efficiency(double sinr, double most) noexcept {
  const double shannon = natural_log(1.0 + sinr) * (1.0 / std::numbers::ln2);
  return shannon < most ? shannon : most;
}

/// 10 log10(SINR), at least -200 dB: the power can be zero in the nulls of an array.
[[gnu::always_inline]] inline double decibel(double sinr) noexcept {
  constexpr double least = 1e-20;
  return natural_log(sinr < least ? least : sinr) * (10.0 / std::numbers::ln10);
}

}  // namespace aloft::radio
