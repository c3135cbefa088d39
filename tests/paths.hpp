#pragma once

#include <filesystem>

namespace aloft::test {

/// The root of the checkout that is tested. A function, so that no test is compiled with its path: a compiler cache
/// then serves checkouts anywhere.
[[nodiscard]] std::filesystem::path source_dir();

/// The folder of this build's programs.
[[nodiscard]] std::filesystem::path bin_dir();

}  // namespace aloft::test
