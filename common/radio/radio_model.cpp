#include "common/radio/radio_model.hpp"

#include <array>
#include <limits>
#include <numbers>

#include "common/radio/approximations.hpp"
#include "common/radio/reading.hpp"

namespace aloft::radio {
namespace {

constexpr double speed_of_light_m_per_s = 3e8;

constexpr std::array<Choice<UavAntenna>, 2> uav_antennas{
    {{"directional", UavAntenna::directional}, {"omnidirectional", UavAntenna::omnidirectional}}};
constexpr std::array<Choice<BsAntenna>, 3> bs_antennas{
    {{"array", BsAntenna::array}, {"sector", BsAntenna::sector}, {"3gpp", BsAntenna::tr_38_901}}};
constexpr std::array<Choice<FadingKind>, 3> fading_kinds{
    {{"independent", FadingKind::independent}, {"none", FadingKind::none}, {"correlated", FadingKind::correlated}}};
constexpr std::array<Choice<ServingSelection>, 2> serving_selections{
    {{"best-of-candidates", ServingSelection::best_of_candidates}, {"best-of-all", ServingSelection::best_of_all}}};

/// A parameter that worlds from before it existed do not name.
ParameterSpec implied(ParameterSpec spec) {
  spec.default_is_implied = true;
  return spec;
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

const std::vector<ParameterSpec>& radio_parameters() {
  static const std::vector<ParameterSpec> table = {
      choice_parameter("uav_antenna", uav_antennas,
                       "UAV antenna: a beam that points at the base station, or all directions with gain 1."),
      number_parameter("uav_beamwidth_deg", 45.0, 1.0, 170.0, "Beamwidth of the directional UAV antenna."),
      choice_parameter("bs_antenna", bs_antennas,
                       "Base station antenna: vertical array of 8 elements; one rectangular sector, steered at the "
                       "UAV it serves, and else at a fixed random azimuth; or the element of 3GPP TR 38.901."),
      number_parameter("bs_beamwidth_deg", 45.0, 1.0, 170.0, "Beamwidth of a base station's sector."),
      implied(number_parameter("bs_downtilt_deg", 0.0, 0.0, 90.0, "Antenna `3gpp`: how far its beam points down.")),
      choice_parameter("fading", fading_kinds,
                       "Rayleigh fading per route point, height, candidate and transmitter: independent, none, or "
                       "correlated over height."),
      number_parameter("fading_correlation", 1.0, 0.0, 1.0,
                       "Fading `correlated`: correlation of amplitudes 1 m of height apart; 1 is constant."),
      choice_parameter("serving_selection", serving_selections,
                       "Serving cell: best SINR of the candidates, or of all base stations."),
      integer_parameter("candidates", 5, 1, 50, "Candidates: so many base stations with the largest received power."),
      integer_parameter("neighbours", 4, 0, static_cast<double>(max_neighbours),
                        "Neighbours whose SINR the UAV reports, strongest first."),
      number_parameter("interferer_distance_max_m", 3000.0, 1.0, 20'000.0,
                       "Farthest interferer while the directional UAV antenna points near the horizon."),
      number_parameter("tx_power_w", 40.0, 0.001, 1000.0, "Transmit power of every base station."),
      number_parameter("carrier_ghz", 3.5, 0.1, 100.0, "Carrier frequency."),
      number_parameter("bandwidth_mhz", 20.0, 0.1, 2000.0, "Bandwidth that noise is counted in."),
      number_parameter("noise_figure_db", 10.0, 0.0, 30.0, "Noise figure of the receiver."),
      implied(number_parameter("spectral_efficiency_max", 0.0, 0.0, 50.0,
                               "Greatest spectral efficiency, bit/s/Hz, of the highest modulation; 0: no limit.")),
  };
  return table;
}

RadioModel::RadioModel(const Parameters& world)
    : uav_antenna(world.chosen("uav_antenna", uav_antennas)),
      bs_antenna(world.chosen("bs_antenna", bs_antennas)),
      fading(world.chosen("fading", fading_kinds)),
      serving_selection(world.chosen("serving_selection", serving_selections)),
      candidates(static_cast<std::uint32_t>(world.integer("candidates"))),
      neighbours(static_cast<std::uint32_t>(world.integer("neighbours"))),
      interferer_distance_max_m(world.number("interferer_distance_max_m")),
      noise_w(noise_power_w(world.number("bandwidth_mhz") * 1e6, world.number("noise_figure_db"))),
      bs_downtilt_deg(world.number("bs_downtilt_deg")),
      efficiency_max(world.number("spectral_efficiency_max")),
      fading_correlation(power_to(world.number("fading_correlation"), world.number("height_resolution_m"))) {
  if (efficiency_max == 0.0) efficiency_max = std::numeric_limits<double>::infinity();
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
