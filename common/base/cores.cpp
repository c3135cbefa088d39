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

OnCores::OnCores(const CoreShare& share) noexcept
    : changed_(share.of > 1 && sched_getaffinity(0, sizeof before_, &before_) == 0) {
  if (!changed_) return;
  const auto cores = static_cast<unsigned>(CPU_COUNT(&before_));
  const unsigned first = share.part * cores / share.of;
  const unsigned last = std::max(first + 1, (share.part + 1) * cores / share.of);  // not included
  cpu_set_t ours;
  CPU_ZERO(&ours);
  unsigned place = 0;
  for (unsigned core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &before_)) continue;
    if (place >= first && place < last) CPU_SET(core, &ours);
    ++place;
  }
  sched_setaffinity(0, sizeof ours, &ours);
}

OnCores::~OnCores() {
  if (changed_) sched_setaffinity(0, sizeof before_, &before_);
}

}  // namespace aloft
