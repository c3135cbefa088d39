#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "common/store/result_store.hpp"
#include "tools/aloft/progress.hpp"

namespace aloft::cli {

/// InputError if an agent is a program of the user's, which speaks over DDS alone.
void check_flies_in_process(const experiment::Experiment& experiment);

/// Flies everything of `results`' experiment that is not stored yet, on `threads` threads, without DDS, and `shuffled`
/// in an order that the seed decides.
/// `fail_fast` > 0 stops after that many failed trials; `interrupted` is looked at between flights. Returns one line
/// per failed trial. A full disk pauses it. store::ResultsGone if the folder is deleted, moved or replaced meanwhile.
std::vector<std::string> run_in_process(store::ResultStore& results, unsigned threads, bool shuffled,
                                        unsigned fail_fast, Progress& progress, const std::atomic<bool>& interrupted);

}  // namespace aloft::cli
