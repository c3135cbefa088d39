#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <chrono>
#include <memory>
#include <string_view>

namespace aloft::bus {

/// A bad network, for tests: percentages of the messages, 0 to 100.
struct TestFaults {
  // Messages that are lost: those with at least one RTPS submessage of this kind.
  unsigned data = 0;
  unsigned data_frag = 0;
  unsigned heartbeat = 0;
  unsigned acknack = 0;
  unsigned gap = 0;
  unsigned any = 0;  ///< whatever is in them
  unsigned duplicate = 0;
  /// Messages that are held back, each for a random time up to delay_limit; others overtake them.
  unsigned delay = 0;
  std::chrono::milliseconds delay_limit{20};
};

/// Reads e.g. "data=20,heartbeat=10,duplicate=5,delay=30,delay_ms=2000". InputError if it is none.
[[nodiscard]] TestFaults parse_test_faults(std::string_view text);

/// The transport a participant uses: `udp` itself, or, if the environment variable ALOFT_TEST_FAULTS is set, one like
/// it that suffers these faults, which is logged. InputError if the variable makes no sense.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> with_test_faults(
    std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp);

}  // namespace aloft::bus
