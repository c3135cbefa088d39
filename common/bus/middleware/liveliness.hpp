#pragma once

// Fault of Fast DDS 2.9.1: liveliness AUTOMATIC and MANUAL_BY_PARTICIPANT never notice a dead process while any other
// participant lives.
// Upstream: issue 4373; 3.1.2 notices after the lease.
// Can go when "readers get the strongest live writer" in common/bus/bus_test.cpp passes with AUTOMATIC.

#include <chrono>
#include <fastdds/dds/core/policy/QosPolicies.hpp>

#include "common/bus/middleware/duration.hpp"

namespace aloft::bus {

/// Writers with this policy must call Writer::assert_liveliness; one that does not for 500 ms counts as dead.
inline void notice_dead_writers(dds::LivelinessQosPolicy& liveliness) {
  liveliness.kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
  liveliness.lease_duration = duration(std::chrono::milliseconds(500));
  liveliness.announcement_period = duration(std::chrono::milliseconds(100));
}

}  // namespace aloft::bus
