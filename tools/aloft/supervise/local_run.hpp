#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/participant.hpp"
#include "common/experiment/experiment.hpp"
#include "services/runtime/run_claim.hpp"
#include "tools/aloft/progress.hpp"

namespace aloft::cli {

/// One run of all services on this machine.
struct LocalRun {
  std::filesystem::path dir;  ///< result folder, made and checked by the caller
  unsigned workers = 1;
  unsigned learner_threads = 1;  ///< of each worker
  bool pinned = true;            ///< each worker to its share of the cores
  unsigned fail_fast = 0;
  bool shuffled = false;
  bus::BusOptions place;  ///< an empty `run`: a name of its own, so that runs on one machine stay apart
};

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
/// processes that die, shows progress, and ends them all. The caller has checked the keys of a secured run. Returns
/// true if every flight is stored; trials that failed for good are added to `failures`. All processes have ended when
/// it returns. InputError if the coordinator refuses to work; store::ResultsGone if the folder is deleted, moved or
/// replaced.
bool run_local(const LocalRun& run, const experiment::Experiment& experiment, Progress& progress,
               const std::atomic<bool>& interrupted, std::vector<std::string>& failures);

}  // namespace aloft::cli
