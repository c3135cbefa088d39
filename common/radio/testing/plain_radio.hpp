#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/radio/line_of_sight.hpp"
#include "common/world/world.hpp"

namespace aloft::radio {

/// The link budget and the interferers by their definition, one link at a time, for tests: line of sight everywhere, or
/// among the buildings of a city, in the preset `published` with other antennas, rays or path exponents at most.
class PlainRadio {
 public:
  PlainRadio(const Parameters& world, std::vector<world::Site> sites, const std::optional<world::City>& city = {})
      : world_(world), sites_(std::move(sites)) {
    if (city) skyline_.emplace(*city);
  }

  [[nodiscard]] bool blocked(world::Position uav, std::size_t k, double h) const {
    const auto ray = world_.text("los_ray") == "geometric" ? LosRay::geometric : LosRay::published;
    return skyline_ && h < skyline_->blocking_height_m(ray, uav, sites_[k].position);
  }

  [[nodiscard]] double power_w(world::Position uav, std::size_t k, double h) const {
    const double d = std::hypot(distance(uav, k), h - 30);
    const double s = (h - 30) / d;
    const double g = std::pow(std::sin(4 * pi * s) / std::sin(pi * s / 2), 2) / 8;
    const double uav_gain = world_.text("uav_antenna") == "directional" ? 16 * pi / std::pow(pi / 4, 2) : 1.0;
    const double bs_gain = world_.text("bs_antenna") == "sector" ? 16 * pi / std::pow(pi / 4, 2) : g;
    return 40 * uav_gain * bs_gain * std::pow(3e8 / (4 * pi * 3.5e9), 2) *
           std::pow(d, -world_.number(blocked(uav, k, h) ? "path_exponent_nlos" : "path_exponent_los"));
  }

  [[nodiscard]] bool interferes(world::Position uav, std::size_t c, std::size_t k, double h) const {
    const double towards_uav = azimuth(uav, k) + pi;
    if (world_.text("bs_antenna") == "sector" &&
        std::fabs(std::remainder(towards_uav - sites_[k].azimuth_deg * pi / 180, 2 * pi)) >= pi / 8)
      return false;
    if (world_.text("uav_antenna") == "omnidirectional") return true;
    if (std::fabs(std::remainder(azimuth(uav, c) - azimuth(uav, k), 2 * pi)) >= pi / 8) return false;
    const double theta = std::atan2(h - 30, distance(uav, c));
    const double nearest_m = theta < pi / 2 - pi / 8 ? (h - 30) / std::tan(theta + pi / 8) : 0.0;
    double farthest_m = 3000;
    if (theta > pi / 2 - pi / 8)
      farthest_m = h - 30;
    else if (theta > pi / 8)
      farthest_m = (h - 30) / std::tan(theta - pi / 8);
    return distance(uav, k) >= nearest_m && distance(uav, k) <= farthest_m;
  }

 private:
  static constexpr double pi = std::numbers::pi;

  [[nodiscard]] double distance(world::Position uav, std::size_t k) const {
    return std::hypot(sites_[k].position.x_m - uav.x_m, sites_[k].position.y_m - uav.y_m);
  }
  [[nodiscard]] double azimuth(world::Position uav, std::size_t k) const {
    return std::atan2(sites_[k].position.y_m - uav.y_m, sites_[k].position.x_m - uav.x_m);
  }

  Parameters world_;
  std::vector<world::Site> sites_;
  std::optional<Skyline> skyline_;
};

}  // namespace aloft::radio
