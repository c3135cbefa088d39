#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "services/runtime/run_claim.hpp"
#include "tools/aloft/progress.hpp"
#include "tools/aloft/supervise/local_experiment.hpp"

namespace aloft::cli {

/// A run's name given by a user, who can give it twice by mistake. Held as long as this object lives.
class RunName {
 public:
  /// Listens for a moment. InputError, naming the other coordinator, if this run has one on this machine or in reach;
  /// nothing is written then.
  RunName(const bus::BusOptions& place, const std::atomic<bool>& interrupted);

 private:
  runtime::RunClaim claim_;
};

/// Starts metrics, coordinator and workers, and the discovery server if its address is one of this machine; restarts
/// processes that die, shows progress, and ends them all. The caller has made and checked the result folder `dir`, and
/// the keys of a secured run. Without a name for the run it gets one of its own, so that runs on one machine stay
/// apart. Returns true if every flight is stored; trials that failed for good are added to `failures`. All processes
/// have ended when it returns. InputError if the coordinator refuses to work; store::ResultsGone if the folder is
/// deleted, moved or replaced.
bool run_local(const std::filesystem::path& dir, const FlyingOptions& options, const experiment::Experiment& experiment,
               Progress& progress, const std::atomic<bool>& interrupted, std::vector<std::string>& failures);

}  // namespace aloft::cli
