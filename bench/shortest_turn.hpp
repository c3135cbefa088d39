#pragma once

#include <algorithm>
#include <ctime>

namespace bench {

/// CPU time of this thread in seconds; other programs do not count.
inline double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs `run` once and lowers `best_s` to its time. Alternatives that are compared take many short turns: the shortest
/// turn of each is then from a time in which nothing else disturbed the core.
template <typename Run>
void shortest_turn(double& best_s, Run run) {
  const double start_s = thread_seconds();
  run();
  best_s = std::min(best_s, thread_seconds() - start_s);
}

}  // namespace bench
