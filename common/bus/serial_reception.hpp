#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <memory>

namespace aloft::bus {

/// `below`, but what arrives is handled one message at a time. The middleware's receiving threads share unprotected
/// data while they authenticate others (Fast DDS 2.9.1; upstream pull requests 3362 and 4188): two who are met at the
/// same moment would be mixed up, and one of them would never be answered.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> with_serial_reception(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below);

}  // namespace aloft::bus
