#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/base/parameters.hpp"

namespace aloft::train {

/// How the network for one kind of quality is trained.
[[nodiscard]] const std::vector<ParameterSpec>& stage_parameters(radio::QosKind kind);

struct Config {
  Parameters spectral_efficiency;
  Parameters throughput;

  /// Every default filled in, keys sorted.
  [[nodiscard]] nlohmann::json canonical() const;
};

/// A JSON object with the optional keys "spectral_efficiency" and "throughput". InputError names file, key and range.
[[nodiscard]] Config read_config(const std::filesystem::path& file);

}  // namespace aloft::train
