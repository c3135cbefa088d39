#pragma once

#include <string>

namespace aloft::test {

/// Reports why a test case cannot run here: `return skip("there is no systemd-analyze");`. If nothing fails, the
/// program ends with exit code 77, which ctest reports as "skipped" for tests that are declared with NEEDS
/// (aloft_add_test), and as a failure for all others.
void skip(const std::string& reason);

}  // namespace aloft::test
