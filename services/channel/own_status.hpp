#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"

namespace aloft::channel {

/// A worker's status: its identity, what it has done since it started, and why it gave up leases. No bus.
class OwnStatus {
 public:
  /// `flies_only`: names of agents; empty: all.
  OwnStatus(std::string_view worker, const std::vector<std::string>& flies_only);

  void begin(const std::string& experiment_id) { status_.experiment_id(wire::experiment_id(experiment_id)); }
  /// Counts a flown step and the time that the agent took to answer.
  void count_step(double answer_s);
  void count_flight();
  /// Only the latest limits::failures_told are reported.
  void add_failure(std::uint64_t lease, std::string_view reason);

  /// The next heartbeat. The caller fills in what holds only at this moment: capacity, leases, agents, records, drops,
  /// missing peers.
  [[nodiscard]] wire::WorkerStatus next();

 private:
  wire::WorkerStatus status_;
};

}  // namespace aloft::channel
