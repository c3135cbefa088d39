#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>

namespace aloft::bus {

/// What may happen to a message. The first five lose it if it has at least one RTPS submessage of this kind, `any`
/// whatever is in it; `delay` holds it back for a random time, so that others overtake it.
enum class TestFault : std::uint8_t { data, data_frag, heartbeat, acknack, gap, any, duplicate, delay };
inline constexpr std::size_t test_fault_count = 8;

/// A bad network, for tests.
struct TestFaults {
  std::array<unsigned, test_fault_count> percent{};  ///< of the messages, by TestFault: 0 to 100
  std::chrono::milliseconds delay_limit{20};
};

/// Reads e.g. "data=20,heartbeat=10,duplicate=5,delay=30,delay_ms=2000". InputError if it is none.
[[nodiscard]] TestFaults parse_test_faults(std::string_view text);

/// The transport a participant uses: `udp` itself, or, if the environment variable ALOFT_TEST_FAULTS is set, one like
/// it that suffers these faults, which is logged, at its end with how often each has happened. InputError if the
/// variable makes no sense.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> with_test_faults(
    std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp);

}  // namespace aloft::bus
