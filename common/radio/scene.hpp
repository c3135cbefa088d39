#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/radio/gaussian_fields.hpp"
#include "common/radio/link_budget.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/radio/radio_model.hpp"
#include "common/radio/signal_map.hpp"
#include "common/world/world.hpp"

namespace aloft::radio {

/// The geometry at one ground position that is the same for all heights.
struct Surroundings {
  world::Position position;
  std::vector<Link> links;                  ///< per base station
  std::vector<std::uint8_t> sector_covers;  ///< per base station: 1 if its sector, at its fixed azimuth, covers the UAV
  std::vector<double> horizontal_loss_db;   ///< per base station: that of the antenna of TR 38.901; else 0
};

/// A city with its radio: the power of every base station at every place, before fading.
class Scene {
 public:
  /// `world`: every key of generated_world_parameters(). Keeps a copy of the city. InputError if it has
  /// more base stations than limits::base_stations.
  Scene(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial);
  /// At other heights than the world's, with these azimuths of sector antennas, in half turns: azimuth / 180 degrees.
  /// Without shadowing: for those who know no more of it than its mean.
  Scene(const Parameters& world, world::City city, std::uint64_t seed, std::uint32_t trial, const HeightGrid& heights,
        std::vector<double> sector_azimuths);
  Scene(const Scene&) = delete;  // the channel model refers to the city in here
  Scene& operator=(const Scene&) = delete;

  [[nodiscard]] const RadioModel& model() const noexcept { return model_; }
  [[nodiscard]] const LinkModel& link_model() const noexcept { return *link_model_; }
  [[nodiscard]] const world::City& city() const noexcept { return city_; }
  [[nodiscard]] const HeightGrid& heights() const noexcept { return heights_; }
  /// Per base station, in half turns; empty if they have no sector antennas.
  [[nodiscard]] const std::vector<double>& sector_azimuths() const noexcept { return sector_azimuths_; }
  /// Unit vectors, per base station; empty if they have no sector antennas.
  [[nodiscard]] const std::vector<world::Position>& sector_boresights() const noexcept { return sector_boresight_; }
  [[nodiscard]] std::uint32_t stations() const noexcept {
    return static_cast<std::uint32_t>(city_.base_stations.size());
  }
  /// Height above the base stations' antennas.
  [[nodiscard]] double rise_m(std::uint32_t height_index) const noexcept {
    return heights_.height_m(height_index) - city_.base_station_height_m;
  }

  void look_around(world::Position position, Surroundings& into) const;
  /// The link of station k alone, were it at `station`: from around.position.
  void look_towards(world::Position station, std::uint32_t k, Surroundings& around) const;

  [[nodiscard]] static LinkPlace link(const Surroundings& around, std::uint32_t k) noexcept {
    return {around.position, k, around.links[k].distance_m};
  }
  /// First index of heights() with line of sight, given the link's blocking height; their number if there is none.
  [[nodiscard]] std::uint32_t first_los(double blocking_height_m) const noexcept;
  /// Multiplies the mean gains of a link, all with or all without line of sight, by its shadowing.
  void shadow(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m, double* gain) const;
  /// Upper bound of the link's gain at all heights.
  [[nodiscard]] double gain_bound(const LinkPlace& link, bool line_of_sight) const;
  /// Loss of the link by shadowing, dB; negative where it is received better than on average.
  [[nodiscard]] double shadowing_db(const LinkPlace& link, bool line_of_sight, double height_m) const;
  /// Power of base station k, W, before fading, with the UAV at ascending heights, line of sight from index `first_los`
  /// on.
  /// `rise_m`: the same heights above the base stations' antennas.
  void received_power_row(const Surroundings& around, std::uint32_t k, std::span<const double> height_m,
                          std::span<const double> rise_m, std::size_t first_los, double* power_w) const;

  /// Whether base station k can interfere with c at all: it must be within the azimuths of the UAV's beam towards c,
  /// and its sector, if it has one, must cover the UAV.
  [[nodiscard]] bool can_interfere(const Surroundings& around, std::uint32_t c, std::uint32_t k) const noexcept {
    if (k == c || around.sector_covers[k] == 0) return false;
    return model_.uav_antenna == UavAntenna::omnidirectional || same_azimuth(model_, around.links[c], around.links[k]);
  }

  /// The number of base stations whose SINR is wanted at every height: all, or the strongest by received power.
  [[nodiscard]] std::uint32_t reported_stations() const noexcept;
  /// How many of these, the strongest ones, can serve.
  [[nodiscard]] std::uint32_t serving_candidates() const noexcept;

 private:
  world::City city_;
  std::uint32_t cells_per_site_;
  RadioModel model_;
  std::unique_ptr<const LinkModel> link_model_;
  std::array<std::optional<GaussianFields>, 2> shadowing_;  // without and with line of sight
  HeightGrid heights_;
  std::vector<double> sector_azimuths_;
  std::vector<world::Position> sector_boresight_;  // unit vectors, per base station
};

/// The heights of a generated world.
[[nodiscard]] HeightGrid height_grid(const Parameters& world);

}  // namespace aloft::radio
