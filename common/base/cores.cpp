#include "common/base/cores.hpp"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace aloft {

unsigned usable_cores() noexcept {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) return static_cast<unsigned>(std::max(1, CPU_COUNT(&cores)));
  return std::max(1U, std::thread::hardware_concurrency());  // more cores than the set can name
}

}  // namespace aloft
