#pragma once

#include <memory>

#include "common/base/parameters.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::radio {

/// The radio over a generated city: spectral efficiency at every route point and height of one trial. `world`: resolved
/// by resolve_generated_world(). Fading depends on (seed, trial) and the place alone, never on earlier calls.
[[nodiscard]] std::unique_ptr<SignalMap> make_generated_map(const Parameters& world, const world::City& city,
                                                            std::uint64_t seed, std::uint32_t trial);

}  // namespace aloft::radio
