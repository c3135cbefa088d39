#pragma once

// Fault of Fast DDS 2.9.1: the receiving threads share unprotected data while they authenticate others
// (match_builtin_endpoints). Two peers that arrive at the same moment are mixed up, and one of them is never answered.
// Upstream: pull requests 3362 and 4188.
// Can go when "all processes of a secured run that start together meet" (tests/integration/secured_bus_test.cpp) passes
// a dozen times on a busy machine without it. 3.1.2 still loses pairs, with it and without it (so no run is
// secured there); 3.3.0 lost none in 11 starts.

#include "common/bus/middleware/receiving_transport.hpp"

namespace aloft::bus {

/// `below`, handing the middleware one message at a time.
[[nodiscard]] Transport one_message_at_a_time(Transport below);

}  // namespace aloft::bus
