#pragma once

#include <filesystem>
#include <string>

namespace aloft::test {

/// A file of the authors' measurements over Grand Canal Quay, which are not ours to ship. Where it is missing, the path
/// is empty and the test case is skipped: `if (file.empty()) return;`.
[[nodiscard]] std::filesystem::path published_file(const std::string& name);

}  // namespace aloft::test
