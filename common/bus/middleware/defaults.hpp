#pragma once

// Defaults of Fast DDS that lose data, hang, or let the working directory change a run; 2.9.1 and 3.3.0 have them:
// - a reliable writer asks its readers every 3 s what they miss: one that fills its history stalls at 150 messages/s;
// - 10 keys: for the 11th, write() returns false;
// - no sample allocated beforehand (allocated_samples = 0) makes early writes fail;
// - a DEFAULT_FASTRTPS_PROFILES.xml (3.x: DEFAULT_FASTDDS_PROFILES.xml) in the working directory is loaded.
// Upstream documents them and does not count them as faults. The first three are seen by "many keys: none is lost" in
// common/bus/bus_test.cpp.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>

#include "common/bus/middleware/duration.hpp"

namespace aloft::bus {

/// Room for `depth` samples of each of `keys` keys. Cost grows with live keys: 6-10 us per write at 1,000.
inline void make_room(int depth, int keys, dds::ResourceLimitsQosPolicy& limits) {
  limits.max_instances = keys;
  limits.max_samples_per_instance = depth;
  limits.max_samples = depth * keys;
  limits.allocated_samples = std::min(16, depth * keys);
}

/// Loss is noticed within 20 ms.
inline void notice_loss(dds::RTPSReliableWriterQos& qos) {
  heartbeat_period(qos) = duration(std::chrono::milliseconds(20));
}

/// To be called before the first participant is made.
inline void ignore_working_directory() {
  setenv("SKIP_DEFAULT_XML_FILE", "1", 0);
}

}  // namespace aloft::bus
