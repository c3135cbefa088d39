#include "common/radio/radio_model.hpp"

#include <numbers>

#include "common/radio/approximations.hpp"

namespace aloft::radio {
namespace {

constexpr double speed_of_light_m_per_s = 3e8;

double power_of_ten(double x) noexcept {
  return exp2(x * (std::numbers::ln10 / std::numbers::ln2));
}

double power_to(double base, double exponent) noexcept {
  return base == 0.0 ? 0.0 : exp2(exponent * natural_log(base) / std::numbers::ln2);
}

}  // namespace

double beam_gain(double beamwidth_rad) noexcept {
  return 16.0 * std::numbers::pi / (beamwidth_rad * beamwidth_rad);
}

double near_field_gain(double carrier_hz) noexcept {
  const double x = speed_of_light_m_per_s / (4.0 * std::numbers::pi * carrier_hz);
  return x * x;
}

double noise_power_w(double bandwidth_hz, double noise_figure_db) noexcept {
  constexpr double thermal_mw_per_hz_db = -174.0;
  return 1e-3 * bandwidth_hz * power_of_ten((thermal_mw_per_hz_db + noise_figure_db) / 10.0);
}

RadioModel::RadioModel(const Parameters& world)
    : los_ray(world.text("los_ray") == "published" ? LosRay::published : LosRay::geometric),
      uav_antenna(world.text("uav_antenna") == "directional" ? UavAntenna::directional : UavAntenna::omnidirectional),
      bs_antenna(world.text("bs_antenna") == "array" ? BsAntenna::array : BsAntenna::sector),
      path_distance(world.text("path_distance") == "slant" ? PathDistance::slant : PathDistance::horizontal),
      fading(world.text("fading") == "independent" ? FadingKind::independent
             : world.text("fading") == "none"      ? FadingKind::none
                                                   : FadingKind::correlated),
      serving_selection(world.text("serving_selection") == "best-of-all" ? ServingSelection::best_of_all
                                                                         : ServingSelection::best_of_candidates),
      candidates(static_cast<std::uint32_t>(world.integer("candidates"))),
      neighbours(static_cast<std::uint32_t>(world.integer("neighbours"))),
      interferer_distance_max_m(world.number("interferer_distance_max_m")),
      noise_w(noise_power_w(world.number("bandwidth_mhz") * 1e6, world.number("noise_figure_db"))),
      path_exponent_los(world.number("path_exponent_los")),
      path_exponent_nlos(world.number("path_exponent_nlos")),
      fading_correlation(power_to(world.number("fading_correlation"), world.number("height_resolution_m"))) {
  constexpr double rad_per_deg = std::numbers::pi / 180.0;
  const double uav_beamwidth_deg = world.number("uav_beamwidth_deg");
  const double bs_beamwidth_deg = world.number("bs_beamwidth_deg");
  const double uav_gain = uav_antenna == UavAntenna::directional ? beam_gain(uav_beamwidth_deg * rad_per_deg) : 1.0;
  link_gain_w = world.number("tx_power_w") * uav_gain * near_field_gain(world.number("carrier_ghz") * 1e9);
  sector_gain = beam_gain(bs_beamwidth_deg * rad_per_deg);
  uav_half_beam_cos = cos_pi(uav_beamwidth_deg / 360.0);
  uav_half_beam_tan = cos_pi(0.5 - uav_beamwidth_deg / 360.0) / uav_half_beam_cos;
  bs_half_beam_cos = cos_pi(bs_beamwidth_deg / 360.0);
}

}  // namespace aloft::radio
