#pragma once

#include <cstdint>
#include <memory>

#include "common/experiment/experiment.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::experiment {

/// Everything a UAV can measure in this trial of this condition: city or measured flight, and the radio over it.
[[nodiscard]] std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition, std::uint32_t trial);

}  // namespace aloft::experiment
