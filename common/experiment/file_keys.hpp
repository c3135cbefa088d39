#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/parameters.hpp"

namespace aloft::experiment {

inline constexpr std::uint64_t default_seed = 1;

/// The entries of an experiment file that are plain parameters: name, trials, energy_weight, ...
[[nodiscard]] std::span<const ParameterSpec> file_settings();

/// Every key that an experiment file may have.
[[nodiscard]] std::vector<std::string> file_keys();

}  // namespace aloft::experiment
