#pragma once

#include <filesystem>

#include "services/coordinator/coordinator.hpp"
#include "services/runtime/service.hpp"

namespace aloft::coordinator {

struct ServiceOptions {
  std::filesystem::path experiment;  ///< canonical JSON
  std::filesystem::path results;     ///< folder of results.sqlite
  CoordinatorOptions coordinator;
  double give_up_after_s = 0.0;  ///< without any worker; 0: wait without end, and report it
  /// How long to listen, before the start, for a coordinator of the same run on another machine.
  Clock::duration look_around = std::chrono::milliseconds(500);
};

/// Runs the experiment over the bus until every flight is stored or a stop is requested. InputError if the experiment
/// or the results cannot be used; std::runtime_error naming the trials that failed, or the collector's failure.
void coordinate(runtime::Service& service, const ServiceOptions& options);

}  // namespace aloft::coordinator
