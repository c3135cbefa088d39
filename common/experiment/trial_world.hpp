#pragma once

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/radio/signal_map.hpp"
#include "common/world/local_projection.hpp"
#include "common/world/measured_world.hpp"
#include "common/world/world.hpp"

namespace aloft::experiment {

/// The city of one trial of a generated condition.
[[nodiscard]] world::City make_city(const Experiment& experiment, const Condition& condition, std::uint32_t trial);

/// The flight of a measured condition, the same in every trial, with its base stations if the condition names them.
/// Throws InputError if a file cannot be read, or is not the one that the experiment was resolved with.
[[nodiscard]] world::MeasuredWorld read_measured_world(const Condition& condition);

/// The same, and where on the globe it was.
struct PlacedWorld {
  world::MeasuredWorld world;
  std::vector<world::GeoPosition> places;  ///< [step - 1]; empty if the file does not say
};
[[nodiscard]] PlacedWorld read_placed_world(const Condition& condition);

/// The world of a trial, without the radio.
using TrialWorld = std::variant<world::City, world::MeasuredWorld>;

[[nodiscard]] TrialWorld make_world(const Experiment& experiment, const Condition& condition, std::uint32_t trial);

/// Everything a UAV can measure in this trial of this condition: its world, and the radio over it. std::runtime_error
/// if `world` cannot be one of this condition.
[[nodiscard]] std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment,
                                                                const Condition& condition, std::uint32_t trial,
                                                                const TrialWorld& world);
/// The same with another seed than the experiment's.
[[nodiscard]] std::unique_ptr<radio::SignalMap> make_signal_map(const Condition& condition, std::uint64_t seed,
                                                                std::uint32_t trial, const TrialWorld& world);
/// The same over the world that make_world() gives.
[[nodiscard]] std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment,
                                                                const Condition& condition, std::uint32_t trial);

}  // namespace aloft::experiment
