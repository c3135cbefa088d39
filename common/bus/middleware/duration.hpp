#pragma once

#include <fastrtps/qos/QosPolicies.h>

#include <chrono>
#include <cstdint>

namespace aloft::bus {

[[nodiscard]] inline eprosima::fastrtps::Duration_t duration(std::chrono::milliseconds ms) {
  return {static_cast<std::int32_t>(ms.count() / 1000), static_cast<std::uint32_t>(ms.count() % 1000) * 1'000'000U};
}

}  // namespace aloft::bus
