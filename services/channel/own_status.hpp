#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"

namespace aloft::channel {

/// What a worker says about itself: who it is, what it has done since it started, and why it gave up leases. No bus.
class OwnStatus {
 public:
  /// `flies_only`: agents; none: all.
  OwnStatus(std::string_view worker, const std::vector<std::string>& flies_only);

  void begin(const std::string& experiment_id) { status_.experiment_id(wire::experiment_id(experiment_id)); }
  /// A step was flown; the agent took so long to answer.
  void count_step(double answer_s);
  void count_flight();
  /// The latest limits::failures_told are told.
  void add_failure(std::uint64_t lease, std::string_view reason);

  /// The next heartbeat. What holds only at this moment is for the caller to fill in: capacity, leases, agents,
  /// records, drops, who is missing.
  [[nodiscard]] wire::WorkerStatus next();

 private:
  wire::WorkerStatus status_;
};

}  // namespace aloft::channel
