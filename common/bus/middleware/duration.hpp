#pragma once

#include <chrono>
#include <cstdint>

#include "common/bus/middleware/generation.hpp"

namespace aloft::bus {

[[nodiscard]] inline Duration duration(std::chrono::milliseconds ms) {
  return {static_cast<std::int32_t>(ms.count() / 1000), static_cast<std::uint32_t>(ms.count() % 1000) * 1'000'000U};
}

}  // namespace aloft::bus
