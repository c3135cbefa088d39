#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::radio {

/// A link of a trial: a UAV somewhere above `uav`, and a base station of the city.
struct LinkPlace {
  world::Position uav;
  std::uint32_t station = 0;
  double distance_m = 0.0;  ///< horizontal, between the two
};

/// Shadowing: normally distributed in dB, mean 0, correlated over the ground as exp(-distance / correlation distance).
struct Shadowing {
  double deviation_db = 0.0;
  double correlation_distance_m = 0.0;
};

/// A channel model: how a link's gain depends on place and line of sight, antennas and fast fading apart. One object
/// serves all links of a trial and is a pure function of place: the order of questions does not matter. Gains are
/// multiples of the gain of free space at 1 m, (c / (4 pi f))^2, which the link budget counts once for all links.
class LinkModel {
 public:
  virtual ~LinkModel() = default;

  /// No line of sight below this height of the UAV, m; from this height on there is.
  [[nodiscard]] virtual double blocking_height_m(const LinkPlace& link) const = 0;

  /// gain[i]: mean gain with the UAV at height_m[i], all of them with line of sight or all without. No element depends
  /// on another: a row has the bits of its elements alone.
  virtual void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                             double* gain) const = 0;

  /// At no height, from the base stations' up, is the mean gain greater.
  [[nodiscard]] virtual double gain_bound(const LinkPlace& link, bool line_of_sight) const = 0;

  /// Of this link with the UAV at this height. No model has any yet, and nothing draws it.
  [[nodiscard]] virtual Shadowing shadowing(const LinkPlace& link, bool line_of_sight, double height_m) const;
};

/// Of worlds that name none.
inline constexpr std::string_view default_link_model = "power-law";

/// Facts about one channel model.
struct LinkModelType {
  std::string name;         ///< as in experiment files: the value of `propagation`
  std::string description;  ///< one sentence
  /// Keys of a generated world that has this model, beside those that every generated world has.
  std::vector<ParameterSpec> parameters{};
  /// For one trial; the city outlives the model.
  std::function<std::unique_ptr<LinkModel>(const Parameters& world, const world::City& city, std::uint64_t seed,
                                           std::uint32_t trial)>
      make{};
};

/// Called once per model file, at namespace scope: `const bool power_law_registered = register_link_model({...});`
bool register_link_model(LinkModelType type);

/// All models, sorted by name.
[[nodiscard]] std::span<const LinkModelType> link_model_types();
/// std::logic_error if there is none of this name: experiments are checked when they are read.
[[nodiscard]] const LinkModelType& link_model_type(std::string_view name);

}  // namespace aloft::radio
