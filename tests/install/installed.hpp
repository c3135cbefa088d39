#pragma once

#include <string>

#include "tests/integration/command.hpp"

namespace aloft::test {

/// Where this build has been installed with cmake --install, and then moved to, as a user may do. Made once per
/// program.
[[nodiscard]] const std::filesystem::path& installed();

/// All files below a folder, sorted, relative to it.
[[nodiscard]] std::vector<std::string> files_below(const std::filesystem::path& folder);

}  // namespace aloft::test
