#include "common/radio/height_rows.hpp"

#include "common/base/random.hpp"

namespace aloft::radio {
namespace {

template <BsAntenna antenna, PathDistance path>
void power_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, std::uint32_t first_los,
               double* power_w) {
  const std::size_t size = rise_m.size();
  for (std::size_t i = 0; i < first_los; ++i)
    power_w[i] = received_power_w<antenna, path>(model, distance_m, rise_m[i], model.path_exponent_nlos);
  for (std::size_t i = first_los; i < size; ++i)
    power_w[i] = received_power_w<antenna, path>(model, distance_m, rise_m[i], model.path_exponent_los);
}

}  // namespace

void received_power_row(const RadioModel& model, double distance_m, std::span<const double> rise_m,
                        std::uint32_t first_los, double* power_w) {
  const bool slant = model.path_distance == PathDistance::slant;
  if (model.bs_antenna == BsAntenna::array)
    (slant ? power_row<BsAntenna::array, PathDistance::slant>
           : power_row<BsAntenna::array, PathDistance::horizontal>)(model, distance_m, rise_m, first_los, power_w);
  else
    (slant ? power_row<BsAntenna::sector, PathDistance::slant>
           : power_row<BsAntenna::sector, PathDistance::horizontal>)(model, distance_m, rise_m, first_los, power_w);
}

void beam_limits_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, double* nearest_m,
                     double* farthest_m) {
  for (std::size_t i = 0; i < rise_m.size(); ++i) {
    const BeamLimits limits = beam_limits(model, distance_m, rise_m[i]);
    nearest_m[i] = limits.nearest_m;
    farthest_m[i] = limits.farthest_m;
  }
}

void exponential_row(std::span<const std::uint32_t> words, double* out) {
  for (std::size_t i = 0; i < words.size(); ++i) out[i] = -natural_log(unit_interval(words[i]));
}

void spectral_efficiency_row(std::span<const double> sinr, double* out) {
  for (std::size_t i = 0; i < sinr.size(); ++i) out[i] = spectral_efficiency(sinr[i]);
}

void decibel_row(std::span<const double> sinr, double* out) {
  for (std::size_t i = 0; i < sinr.size(); ++i) out[i] = decibel(sinr[i]);
}

}  // namespace aloft::radio
