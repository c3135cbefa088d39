#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aloft::cli {

/// Names of the experiments that come with the program, sorted: the files of share/aloft/experiments beside its bin/.
[[nodiscard]] std::vector<std::string> package_experiments();

/// The file `given` if it exists, or else the package's experiment of that name. InputError lists the package's
/// experiments.
[[nodiscard]] std::filesystem::path find_experiment(const std::filesystem::path& given);

}  // namespace aloft::cli
