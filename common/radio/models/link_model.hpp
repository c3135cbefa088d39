#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::radio {

/// A link of a trial: a UAV at any height above `uav`, and a base station of the city.
struct LinkPlace {
  world::Position uav;
  std::uint32_t station = 0;
  double distance_m = 0.0;  ///< horizontal, between the two
};

/// Shadowing (Gudmundson 1991): normally distributed in dB, mean 0, correlated over the ground as
/// exp(-distance / correlation distance), independent between base stations, and between links with and without line of
/// sight.
struct Shadowing {
  double deviation_max_db = 0.0;  ///< greatest standard deviation of all links; 0: there is no shadowing
  double correlation_distance_m = 0.0;
};

/// A channel model: how a link's gain, without antennas and fast fading, depends on place and line of sight. One object
/// serves all links of a trial and is a pure function of place: the order of calls does not matter. Gains are relative
/// to free space at 1 m, (c / (4 pi f))^2, which the link budget multiplies once for all links.
class LinkModel {
 public:
  virtual ~LinkModel() = default;

  /// The lowest height of the UAV, m, with line of sight.
  [[nodiscard]] virtual double blocking_height_m(const LinkPlace& link) const = 0;

  /// Whether height_m is at least blocking_height_m(). The default compares; a model can be faster.
  [[nodiscard]] virtual bool line_of_sight(const LinkPlace& link, double height_m) const;

  /// gain[i] is the mean gain with the UAV at height_m[i], which ascend; line of sight is the same for the whole row.
  /// Elements do not depend on each other: each has the same bits as in a row of its own.
  virtual void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                             double* gain) const = 0;

  /// gain[k] is the mean gain of the link to base station k, at distance_m[k] from `uav`, with the UAV at height_m;
  /// line of sight is the same for all links. Each has the same bits as mean_gain_row() gives. The default asks that,
  /// link by link; a model can be faster.
  virtual void mean_gains(world::Position uav, std::span<const double> distance_m, bool line_of_sight, double height_m,
                          double* gain) const;

  /// Upper bound of the mean gain at all heights from that of the base stations upwards.
  [[nodiscard]] virtual double gain_bound(const LinkPlace& link, bool line_of_sight) const = 0;

  /// Shadowing of all links with or without line of sight, which the radio draws and multiplies with the mean gain. The
  /// default is none.
  [[nodiscard]] virtual Shadowing shadowing(bool line_of_sight) const;
  /// deviation_db[i] is the standard deviation of shadowing with the UAV at height_m[i], which ascend; at most that of
  /// shadowing(). Elements do not depend on each other. The default is 0.
  virtual void shadowing_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                             double* deviation_db) const;
};

/// The model of worlds that name none.
inline constexpr std::string_view default_link_model = "power-law";

/// Facts about one channel model.
struct LinkModelType {
  std::string name;         ///< as in experiment files: the value of `propagation`
  std::string description;  ///< one sentence
  /// Keys of generated worlds with this model, in addition to those of every generated world.
  std::vector<ParameterSpec> parameters{};
  /// Other defaults of number parameters that every generated world has.
  std::map<std::string, double> defaults{};
  /// Throws InputError, naming `where` and a key, for a world that the model does not cover.
  std::function<void(const Parameters& world, std::string_view where)> check{};
  /// Makes the model of one trial; the city outlives it.
  std::function<std::unique_ptr<LinkModel>(const Parameters& world, const world::City& city, std::uint64_t seed,
                                           std::uint32_t trial)>
      make{};
};

/// Called once per model file, at namespace scope: `const bool power_law_registered = register_link_model({...});`
bool register_link_model(LinkModelType type);

/// All models, sorted by name.
[[nodiscard]] std::span<const LinkModelType> link_model_types();
/// Throws std::logic_error for an unknown name: experiments have been checked before.
[[nodiscard]] const LinkModelType& link_model_type(std::string_view name);

}  // namespace aloft::radio
