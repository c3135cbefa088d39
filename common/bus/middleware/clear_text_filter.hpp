#pragma once

// Fault of Fast DDS 2.9.1: a secured participant takes a forged sample in clear text from anybody who writes the
// address of a known writer on it. Upstream: fixed in 3.x (3.1.2 refuses such samples); no issue is known. Can go when
// "a forged sample in clear text" in tests/integration/secured_bus_test.cpp passes without it.

#include <cstddef>

#include "common/bus/middleware/receiving_transport.hpp"

namespace aloft::bus {

/// `below`, made fit for a secured run: what arrives in clear text is dropped, except introductions (see
/// permitted_in_secured_run). Logged and counted.
[[nodiscard]] Transport without_clear_text(Transport below);

/// Whether everything in an RTPS message is encrypted, or belongs to discovering and authenticating participants, which
/// cannot be.
[[nodiscard]] bool permitted_in_secured_run(const unsigned char* bytes, std::size_t size) noexcept;

}  // namespace aloft::bus
