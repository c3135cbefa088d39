#pragma once

#include <string>

namespace aloft::test {

/// A test case that cannot run here says why, and returns: `return skip("there is no systemd-analyze");`. If nothing
/// else fails, the program ends with exit code 77, which ctest calls "skipped" for tests that are declared with NEEDS
/// (aloft_add_test), and a failure for all others.
void skip(const std::string& reason);

}  // namespace aloft::test
