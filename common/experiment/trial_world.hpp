#pragma once

#include <cstdint>
#include <memory>

#include "common/experiment/experiment.hpp"
#include "common/radio/signal_map.hpp"
#include "common/world/world.hpp"

namespace aloft::experiment {

/// The city of one trial of a generated condition.
[[nodiscard]] world::City make_city(const Experiment& experiment, const Condition& condition, std::uint32_t trial);

/// The flight of a measured condition, the same in every trial. Throws InputError if the file is not, or no longer,
/// what the experiment was resolved with.
[[nodiscard]] world::MeasuredFlight read_measured_flight(const Condition& condition);

/// Everything a UAV can measure in this trial of this condition: city or measured flight, and the radio over it.
[[nodiscard]] std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment,
                                                                const Condition& condition, std::uint32_t trial);

}  // namespace aloft::experiment
