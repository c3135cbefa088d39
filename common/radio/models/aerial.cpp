#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

#include "common/base/error.hpp"
#include "common/base/widest_vectors.hpp"
#include "common/radio/aerial_formulas.hpp"
#include "common/radio/aerial_link.hpp"
#include "common/radio/gaussian_fields.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/world/city.hpp"

namespace aloft::radio {
namespace {

/// Correlation distances, m, over the ground: of shadowing (TR 38.901 Table 7.5-6) with and without line of sight, and
/// of line of sight itself (Table 7.6.3.1-2).
struct Correlation {
  double shadowing_los_m = 0.0;
  double shadowing_nlos_m = 0.0;
  double line_of_sight_m = 0.0;
};

constexpr Correlation correlation(AerialScenario scenario) {
  switch (scenario) {
    case AerialScenario::uma:
      return {37.0, 50.0, 50.0};
    case AerialScenario::umi:
      return {10.0, 13.0, 50.0};
    case AerialScenario::rma:
      break;
  }
  return {37.0, 120.0, 60.0};
}

/// Relative to free space at 1 m. Distances in space below 1 m count as 1 m.
template <AerialScenario scenario, bool line_of_sight>
[[gnu::always_inline]] inline double aerial_gain(const CarrierLoss& carrier, double distance_m, double base_m,
                                                 double height_m) noexcept {
  const double rise_m = height_m - base_m;
  const double slant2_m2 = distance_m * distance_m + rise_m * rise_m;
  const double log_slant = 0.5 * log10(slant2_m2 < 1.0 ? 1.0 : slant2_m2);
  const double loss_db = aerial_path_loss_db<scenario, line_of_sight>(carrier, log_slant, log10(height_m));
  return power_of_ten(0.1 * (carrier.free_space_at_1_m_db - loss_db));
}

/// One link at many heights.
template <AerialScenario scenario, bool line_of_sight>
[[gnu::always_inline]] inline void gain_row(const CarrierLoss* carrier, double distance_m, double base_m,
                                            const double* height_m, std::size_t size, double* gain) {
  for (std::size_t i = 0; i < size; ++i)
    gain[i] = aerial_gain<scenario, line_of_sight>(*carrier, distance_m, base_m, height_m[i]);
}

/// Many links at one height.
template <AerialScenario scenario, bool line_of_sight>
[[gnu::always_inline]] inline void station_gains(const CarrierLoss* carrier, const double* distance_m, double base_m,
                                                 double height_m, std::size_t size, double* gain) {
  for (std::size_t k = 0; k < size; ++k)
    gain[k] = aerial_gain<scenario, line_of_sight>(*carrier, distance_m[k], base_m, height_m);
}

template <AerialScenario scenario>
[[gnu::always_inline]] inline void deviation_row(const double* height_m, std::size_t size, double* deviation_db) {
  for (std::size_t i = 0; i < size; ++i) deviation_db[i] = aerial_shadowing_los_db<scenario>(height_m[i]);
}

/// The channel of TR 36.777 Annex B. Whether a link has line of sight follows from a random field over the ground, per
/// site: it has if the field, as a uniform number, is at most the probability at its distance and height.
template <AerialScenario scenario>
class Aerial final : public LinkModel {
 public:
  Aerial(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial)
      : carrier_ghz_(world.number("carrier_ghz")),
        blend_m_(world.number("blend_m")),
        carrier_(carrier_loss(carrier_ghz_)),
        cells_per_site_(world::cells_per_site(world)),
        visibility_(seed, trial, "line of sight", (city.base_stations.size() + cells_per_site_ - 1) / cells_per_site_,
                    correlation(scenario).line_of_sight_m) {}

  [[nodiscard]] double blocking_height_m(const LinkPlace& link) const override {
    return lowest_height_m(at(link, 0.0), normal_cdf(visibility_.at(link.uav, link.station / cells_per_site_)));
  }

  /// Most often the probability decides without the height at which the field equals it.
  [[nodiscard]] bool line_of_sight(const LinkPlace& link, double height_m) const override {
    // More than the probability grows over lowest_height_tolerance_m.
    const double clearly = 1e-4 + (blend_m_ > 0.0 ? lowest_height_tolerance_m / blend_m_ : 0.0);
    const double probability = line_of_sight_probability(at(link, height_m));
    if (probability == 1.0) return true;
    const double level = normal_cdf(visibility_.at(link.uav, link.station / cells_per_site_));
    if (probability < level) return false;
    return probability > level + clearly || height_m >= lowest_height_m(at(link, height_m), level);
  }

  void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* gain) const override {
    if (line_of_sight)
      run_vectorised<gain_row<scenario, true>>(&carrier_, link.distance_m, base_m, height_m.data(), height_m.size(),
                                               gain);
    else
      run_vectorised<gain_row<scenario, false>>(&carrier_, link.distance_m, base_m, height_m.data(), height_m.size(),
                                                gain);
    const std::size_t low = low_heights(height_m);
    for (std::size_t i = 0; i < low; ++i) gain[i] = low_gain(at(link, height_m[i]), line_of_sight);
  }

  void mean_gains(world::Position uav, std::span<const double> distance_m, bool line_of_sight, double height_m,
                  double* gain) const override {
    if (height_m <= table_above_m()) return LinkModel::mean_gains(uav, distance_m, line_of_sight, height_m, gain);
    if (line_of_sight)
      run_vectorised<station_gains<scenario, true>>(&carrier_, distance_m.data(), base_m, height_m, distance_m.size(),
                                                    gain);
    else
      run_vectorised<station_gains<scenario, false>>(&carrier_, distance_m.data(), base_m, height_m, distance_m.size(),
                                                     gain);
  }

  /// With line of sight no formula has less loss than at the height of the base station: that of urban micro cells is
  /// never below free space, nor below 32.4 + 20 log d. Without it, all but the aerial one of urban macro cells have at
  /// least the loss in line of sight; that one falls with the height at equal distances.
  [[nodiscard]] double gain_bound(const LinkPlace& link, bool line_of_sight) const override {
    const double log_distance = log10(std::max(link.distance_m, 1.0));
    double loss_db = carrier_.free_space_at_1_m_db + 20.0 * log_distance;
    if (scenario == AerialScenario::umi) loss_db = 32.4 + 20.0 * log_distance + carrier_.carrier_db;
    if (scenario == AerialScenario::uma)
      loss_db = line_of_sight
                    ? aerial_path_loss_db<scenario, true>(carrier_, log_distance, 0.0)
                    : aerial_path_loss_db<scenario, false>(carrier_, log_distance, log10(aerial_height_max_m));
    return power_of_ten(0.1 * (carrier_.free_space_at_1_m_db - loss_db));
  }

  /// The standard deviation falls with the height, but for the step of urban micro cells without line of sight.
  [[nodiscard]] Shadowing shadowing(bool line_of_sight) const override {
    const auto deviation_db = [&](double height_m) {
      return shadowing_deviation_db({scenario, carrier_ghz_, 0.0, height_m, blend_m_}, line_of_sight);
    };
    return {std::max(deviation_db(base_m), deviation_db(aerial_height_max_m)),
            line_of_sight ? correlation(scenario).shadowing_los_m : correlation(scenario).shadowing_nlos_m};
  }

  void shadowing_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* deviation_db) const override {
    if (line_of_sight) {
      run_vectorised<deviation_row<scenario>>(height_m.data(), height_m.size(), deviation_db);
    } else {
      const double above_db = shadowing_deviation_db(at(link, aerial_height_max_m), false);
      std::fill_n(deviation_db, height_m.size(), above_db);
    }
    const std::size_t low = low_heights(height_m);
    for (std::size_t i = 0; i < low; ++i)
      deviation_db[i] = shadowing_deviation_db(at(link, height_m[i]), line_of_sight);
  }

 private:
  static constexpr double base_m = facts(scenario).base_station_height_m;

  /// Above this height path loss and deviation are those of TR 36.777 alone.
  [[nodiscard]] double table_above_m() const noexcept { return facts(scenario).aerial_above_m + blend_m_; }
  /// How many heights of a row are not above it: they come first.
  [[nodiscard]] std::size_t low_heights(std::span<const double> height_m) const noexcept {
    const double above_m = table_above_m();
    std::size_t low = 0;
    while (low < height_m.size() && height_m[low] <= above_m) ++low;
    return low;
  }
  [[nodiscard]] AerialLink at(const LinkPlace& link, double height_m) const noexcept {
    return {scenario, carrier_ghz_, link.distance_m, height_m, blend_m_};
  }
  [[nodiscard]] double low_gain(const AerialLink& link, bool line_of_sight) const {
    return power_of_ten(0.1 * (carrier_.free_space_at_1_m_db - path_loss_db(link, line_of_sight)));
  }

  double carrier_ghz_;
  double blend_m_;
  CarrierLoss carrier_;
  std::uint32_t cells_per_site_;
  GaussianFields visibility_;
};

/// The longest link on the ground: from the route to a corner of the city.
double farthest_link_m(const Parameters& world) {
  const double start_m = world.number("route_start_x_m");
  const double end_m = start_m + world.number("route_spacing_m") * world.integer("steps");
  const double edge_m = 0.5 * world.number("window_m");
  return std::hypot(edge_m + std::max(std::fabs(start_m), std::fabs(end_m)),
                    edge_m + world.number("route_offset_max_m"));
}

void check_world(AerialScenario scenario, const std::string& name, const Parameters& world, std::string_view where) {
  const AerialScenarioFacts limits = facts(scenario);
  const auto refuse = [&](std::string_view key, const std::string& reason) {
    throw InputError("{}{}{}: {}", where, where.empty() ? "" : ".", key, reason);
  };
  const double base_m = world.number("base_station_height_m");
  const double high_m = world.number("height_max_m");
  const double carrier_ghz = world.number("carrier_ghz");
  const double farthest_m = farthest_link_m(world);
  if (base_m != limits.base_station_height_m)
    refuse("base_station_height_m", fmt::format("{} is not the {} m of {}; leave it out, or use another channel model",
                                                base_m, limits.base_station_height_m, name));
  if (high_m > aerial_height_max_m)
    refuse("height_max_m", fmt::format("{} is above the range of {}, which ends at {} m; use at most that", high_m,
                                       name, aerial_height_max_m));
  if (carrier_ghz < aerial_carrier_min_ghz || carrier_ghz > limits.carrier_max_ghz)
    refuse("carrier_ghz", fmt::format("{} is not allowed; {} is defined from {} to {} GHz", carrier_ghz, name,
                                      aerial_carrier_min_ghz, limits.carrier_max_ghz));
  if (farthest_m > limits.distance_max_m)
    refuse("window_m",
           fmt::format("links up to {:.0f} m are possible from the route to a corner of the city, but {} is "
                       "defined up to {} m; use a smaller city, or a shorter route",
                       farthest_m, name, limits.distance_max_m));
}

/// Implied, because there were worlds with these models before it.
ParameterSpec blend_parameter() {
  ParameterSpec spec =
      number_parameter("blend_m", 0.0, 0.0, aerial_blend_max_m,
                       "Metres of height over which the steps of the tables are softened, above 22.5 and 100 m "
                       "(`rma-av`: 10 and 40 m). 0: steps, as in the standard.");
  spec.default_is_implied = true;
  return spec;
}

template <AerialScenario scenario>
bool register_aerial(const std::string& name, const std::string& description) {
  return register_link_model(
      {.name = name,
       .description = description,
       .parameters = {blend_parameter()},
       .defaults = {{"base_station_height_m", facts(scenario).base_station_height_m}, {"carrier_ghz", 2.0}},
       .check = [name](const Parameters& world, std::string_view where) { check_world(scenario, name, world, where); },
       .make = [](const Parameters& world, const world::City& city, std::uint64_t seed,
                  std::uint32_t trial) { return std::make_unique<Aerial<scenario>>(world, city, seed, trial); }});
}

const bool uma_registered =
    register_aerial<AerialScenario::uma>("uma-av", "Urban macro cells and aerial users: 3GPP TR 36.777, Annex B.");
const bool umi_registered =
    register_aerial<AerialScenario::umi>("umi-av", "Urban micro cells and aerial users: 3GPP TR 36.777, Annex B.");
const bool rma_registered =
    register_aerial<AerialScenario::rma>("rma-av", "Rural macro cells and aerial users: 3GPP TR 36.777, Annex B.");

}  // namespace
}  // namespace aloft::radio
