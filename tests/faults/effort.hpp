#pragma once

#include <cstdlib>

namespace aloft::test {

/// The same tests run in CI and, longer, as the tier soak (environment variable ALOFT_SOAK).
[[nodiscard]] inline bool soak() {
  return std::getenv("ALOFT_SOAK") != nullptr;
}
[[nodiscard]] inline int effort(int in_ci, int in_soak) {
  return soak() ? in_soak : in_ci;
}

}  // namespace aloft::test
