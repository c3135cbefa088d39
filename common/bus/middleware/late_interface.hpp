#pragma once

// Fault of Fast DDS 2.9.1: it receives nothing on an interface that comes up after the participant was made, e.g.
// shortly after boot. Upstream: no issue is known. Can go when a process that starts before `ip link set ... up` hears
// others without it (tests/deploy/systemd_test.cpp).

#include <string>

namespace aloft::bus {

/// std::runtime_error if the interface with this address is still down after 10 s.
void wait_until_running(const std::string& address);

}  // namespace aloft::bus
