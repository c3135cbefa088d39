#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace aloft::test {

/// The text of a random experiment: values from the whole range of every parameter, preferably its ends, in
/// combinations that `aloft validate` partly accepts and partly refuses.
struct RandomExperiment {
  nlohmann::json json;
  bool small = false;  ///< flies in a moment
};

/// `folder`: where the measured flights that it names are written. `small`: only experiments that fly in a moment.
[[nodiscard]] RandomExperiment random_experiment(std::uint64_t seed, const std::filesystem::path& folder, bool small);

}  // namespace aloft::test
