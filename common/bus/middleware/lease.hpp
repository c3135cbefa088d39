#pragma once

// Two faults of Fast DDS, because of which some processes must not be forgotten as soon as they are silent:
// - A process cannot authenticate a second time with a peer that has not forgotten it. No upstream issue is known;
//   2.9.1, 3.1.2 and 3.3.0 have it.
// - If only one of a discovery server and its client forgets the other, they do not find each other again (as upstream
//   issue 6401, and a server has no endpoints that could ask: rediscovery.hpp).
// Can go when "processes of a secured run that stood still" (tests/integration/secured_bus_test.cpp) and "a partition
// of 30 s" (tests/deploy/namespace_test.cpp) pass with the lease of other runs.

#include <chrono>

namespace aloft::bus {

/// A process of a secured run that is silent for this long is forgotten. Longer than any delay on a busy machine.
inline constexpr std::chrono::milliseconds secured_lease{20'000};

/// The same in a run with a discovery server: no peer may be forgotten because a machine was busy for a moment.
inline constexpr std::chrono::milliseconds served_lease{4'000};

}  // namespace aloft::bus
