#pragma once

#include <chrono>

namespace aloft {

[[nodiscard]] constexpr double seconds(std::chrono::duration<double> duration) noexcept {
  return duration.count();
}

}  // namespace aloft
