#pragma once

#include <algorithm>
#include <ctime>

namespace bench {

/// CPU time of this thread in seconds: what other programs take does not count.
inline double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs it once and lowers `best_s` to the time it took. Things that are to be compared take turns, many short ones:
/// the shortest of each is then from a moment in which nothing else disturbed the core.
template <typename Run>
void shortest_turn(double& best_s, Run run) {
  const double start_s = thread_seconds();
  run();
  best_s = std::min(best_s, thread_seconds() - start_s);
}

}  // namespace bench
