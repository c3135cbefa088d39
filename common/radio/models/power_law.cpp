#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>

#include "common/base/widest_vectors.hpp"
#include "common/radio/approximations.hpp"
#include "common/radio/line_of_sight.hpp"
#include "common/radio/models/link_model.hpp"

namespace aloft::radio {
namespace {

enum class PathDistance : std::uint8_t { slant, horizontal };

constexpr std::array<Choice<LosRay>, 2> los_rays{{{"published", LosRay::published}, {"geometric", LosRay::geometric}}};
constexpr std::array<Choice<PathDistance>, 2> path_distances{
    {{"slant", PathDistance::slant}, {"horizontal", PathDistance::horizontal}}};

/// distance^-exponent, from the squared distance in m^2. Exponent 4 needs no logarithm.
[[gnu::always_inline]] inline double path_gain(double distance2_m2, double exponent) noexcept {
  if (exponent == 4.0) {
    const double inverse = 1.0 / distance2_m2;
    return inverse * inverse;
  }
  return exp2((-0.5 / std::numbers::ln2) * exponent * natural_log(distance2_m2));
}

/// Distances below 1 m count as 1 m.
template <PathDistance path>
[[gnu::always_inline]] inline double mean_gain(double distance_m, double rise_m, double exponent) noexcept {
  const double horizontal2_m2 = distance_m * distance_m;
  const double path2_m2 = path == PathDistance::slant ? horizontal2_m2 + rise_m * rise_m : horizontal2_m2;
  return path_gain(path2_m2 < 1.0 ? 1.0 : path2_m2, exponent);
}

/// One link at many heights.
template <PathDistance path>
[[gnu::always_inline]] inline void gain_row(double distance_m, double base_m, const double* height_m, std::size_t size,
                                            double exponent, double* gain) {
  if (exponent == 4.0)  // a constant exponent removes the branch in path_gain()
    for (std::size_t i = 0; i < size; ++i) gain[i] = mean_gain<path>(distance_m, height_m[i] - base_m, 4.0);
  else
    for (std::size_t i = 0; i < size; ++i) gain[i] = mean_gain<path>(distance_m, height_m[i] - base_m, exponent);
}

/// Many links at one height.
template <PathDistance path>
[[gnu::always_inline]] inline void gains(const double* distance_m, double rise_m, std::size_t size, double exponent,
                                         double* gain) {
  if (exponent == 4.0)
    for (std::size_t k = 0; k < size; ++k) gain[k] = mean_gain<path>(distance_m[k], rise_m, 4.0);
  else
    for (std::size_t k = 0; k < size; ++k) gain[k] = mean_gain<path>(distance_m[k], rise_m, exponent);
}

/// The paper's path loss: gain D^-alpha, alpha = 2.1 with line of sight and 4 behind buildings by default. Line of
/// sight is decided as line_of_sight.hpp says.
class PowerLaw final : public LinkModel {
 public:
  PowerLaw(const Parameters& world, const world::City& city)
      : city_(city),
        skyline_(city),
        los_ray_(world.chosen("los_ray", los_rays)),
        path_distance_(world.chosen("path_distance", path_distances)),
        exponent_los_(world.number("path_exponent_los")),
        exponent_nlos_(world.number("path_exponent_nlos")) {}

  [[nodiscard]] double blocking_height_m(const LinkPlace& link) const override {
    return skyline_.blocking_height_m(los_ray_, link.uav, city_.base_stations[link.station]);
  }

  void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* gain) const override {
    const double base_m = city_.base_station_height_m;
    const double alpha = exponent(line_of_sight);
    if (path_distance_ == PathDistance::slant)
      run_vectorised<gain_row<PathDistance::slant>>(link.distance_m, base_m, height_m.data(), height_m.size(), alpha,
                                                    gain);
    else
      run_vectorised<gain_row<PathDistance::horizontal>>(link.distance_m, base_m, height_m.data(), height_m.size(),
                                                         alpha, gain);
  }

  void mean_gains(world::Position /*uav*/, std::span<const double> distance_m, bool line_of_sight, double height_m,
                  double* gain) const override {
    const double rise_m = height_m - city_.base_station_height_m;
    const double alpha = exponent(line_of_sight);
    if (path_distance_ == PathDistance::slant)
      run_vectorised<gains<PathDistance::slant>>(distance_m.data(), rise_m, distance_m.size(), alpha, gain);
    else
      run_vectorised<gains<PathDistance::horizontal>>(distance_m.data(), rise_m, distance_m.size(), alpha, gain);
  }

  [[nodiscard]] double gain_bound(const LinkPlace& link, bool line_of_sight) const override {
    const double horizontal2_m2 = link.distance_m * link.distance_m;
    return path_gain(horizontal2_m2 < 1.0 ? 1.0 : horizontal2_m2, exponent(line_of_sight));
  }

 private:
  [[nodiscard]] double exponent(bool line_of_sight) const noexcept {
    return line_of_sight ? exponent_los_ : exponent_nlos_;
  }

  const world::City& city_;
  Skyline skyline_;
  LosRay los_ray_;
  PathDistance path_distance_;
  double exponent_los_;
  double exponent_nlos_;
};

const bool power_law_registered = register_link_model(
    {.name = "power-law",
     .description = "A power of the distance, with one exponent in line of sight and one behind buildings.",
     .parameters = {choice_parameter(
                        "los_ray", los_rays,
                        "Ray of line of sight: reversed as in the published simulator, or from the UAV to the mast."),
                    choice_parameter("path_distance", path_distances, "Distance that path loss counts."),
                    number_parameter("path_exponent_los", 2.1, 1.0, 8.0, "Path loss exponent with line of sight."),
                    number_parameter("path_exponent_nlos", 4.0, 1.0, 8.0, "Path loss exponent without line of sight.")},
     .make = [](const Parameters& world, const world::City& city, std::uint64_t /*seed*/, std::uint32_t /*trial*/) {
       return std::make_unique<PowerLaw>(world, city);
     }});

}  // namespace
}  // namespace aloft::radio
