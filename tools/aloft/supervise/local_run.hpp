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
  bus::BusOptions place;  ///< an empty `run`: one of its own, so that runs on one machine do not hear each other
};

/// The name of a run that users gave, and may have given twice: held as long as this object lives.
class RunName {
 public:
  /// Listens for a moment. InputError, naming the other one, if the run is coordinated already, on this machine or on
  /// another one that is heard. Nothing has been written then.
  RunName(const bus::BusOptions& place, const std::atomic<bool>& interrupted);

 private:
  runtime::RunClaim claim_;
};

/// Of a secured run the keys have been checked. Starts metrics, coordinator and workers, and the discovery server if
/// its address is one of this machine; restarts what dies, shows progress, and ends them all. Returns true if every
/// flight is stored; what failed for good is added to `failures`. No process of the run is left when it returns.
/// InputError if the coordinator refuses to work; store::ResultsGone if the folder is deleted, moved or replaced
/// meanwhile.
bool run_local(const LocalRun& run, const experiment::Experiment& experiment, Progress& progress,
               const std::atomic<bool>& interrupted, std::vector<std::string>& failures);

}  // namespace aloft::cli
