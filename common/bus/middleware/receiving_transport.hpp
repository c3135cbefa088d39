#pragma once

// No repair, but what two of them stand on: a transport that lets a function of ours see what arrives.

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <cstdint>
#include <functional>
#include <memory>

namespace aloft::bus {

using Transport = std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>;

/// A message that has arrived from `remote`, and what hands it to the middleware. Called by several threads at a time.
using Receive =
    std::function<void(const unsigned char* bytes, std::uint32_t size,
                       const eprosima::fastrtps::rtps::Locator_t& remote, const std::function<void()>& deliver)>;

/// `below`, of which `receive` sees every message first.
[[nodiscard]] Transport receiving_through(Receive receive, Transport below);

}  // namespace aloft::bus
