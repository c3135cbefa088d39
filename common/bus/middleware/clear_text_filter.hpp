#pragma once

// Fault of Fast DDS 2.9.1: a secured participant accepts a forged sample in clear text from any sender that gives the
// address of a known writer. Upstream: fixed in 3.x (3.1.2 refuses such samples); no issue is known. Can go when
// "a forged sample in clear text" in tests/integration/secured_bus_test.cpp passes without it.

#include <cstddef>

#include "common/bus/middleware/receiving_transport.hpp"

namespace aloft::bus {

/// `below` for a secured run: messages that arrive in clear text are dropped, except introductions (see
/// permitted_in_secured_run). Logged and counted.
[[nodiscard]] Transport without_clear_text(Transport below);

/// Whether everything in an RTPS message is encrypted, or belongs to discovering and authenticating participants, which
/// cannot be.
[[nodiscard]] bool permitted_in_secured_run(const unsigned char* bytes, std::size_t size) noexcept;

}  // namespace aloft::bus
