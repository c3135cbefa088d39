#pragma once

// The base of two repairs, itself none: a transport that passes every arriving message to a function of ours.

#include <cstdint>
#include <functional>
#include <memory>

#include "common/bus/middleware/generation.hpp"

namespace aloft::bus {

using Transport = std::shared_ptr<rtps::TransportDescriptorInterface>;

/// Gets a message that arrived from `remote`, and `deliver`, which hands it to the middleware. Called by several
/// threads at a time.
using Receive = std::function<void(const unsigned char* bytes, std::uint32_t size, const rtps::Locator_t& remote,
                                   const std::function<void()>& deliver)>;

/// `below`, with every arriving message passed to `receive` first.
[[nodiscard]] Transport receiving_through(Receive receive, Transport below);

}  // namespace aloft::bus
