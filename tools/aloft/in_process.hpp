#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "common/store/result_store.hpp"
#include "tools/aloft/progress.hpp"

namespace aloft::cli {

/// InputError if an agent is a program of the user's: it communicates over DDS only.
void check_flies_in_process(const experiment::Experiment& experiment);

/// Flies all flights that `results` lacks, on `threads` threads and without DDS; if `shuffled`, in an order drawn from
/// the seed. `fail_fast` > 0 stops after that many failed trials; `interrupted` is read between flights. Returns one
/// line per failed trial. Waits while the disk is full. store::ResultsGone if the folder is deleted, moved or replaced.
std::vector<std::string> run_in_process(store::ResultStore& results, unsigned threads, bool shuffled,
                                        unsigned fail_fast, Progress& progress, const std::atomic<bool>& interrupted);

}  // namespace aloft::cli
