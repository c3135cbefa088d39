#pragma once

#include <sched.h>

namespace aloft {

/// Cores this process may run on, at least 1: fewer than the machine has if the process is pinned to some, as Slurm,
/// containers and taskset do.
[[nodiscard]] unsigned usable_cores() noexcept;

/// One of several equal parts of the usable cores, counted from 0. With more parts than cores, some have the same core.
struct CoreShare {
  unsigned part = 0;
  unsigned of = 1;
};

/// While it lives, this thread and the processes that it starts run on their share of the cores only.
class OnCores {
 public:
  explicit OnCores(const CoreShare& share) noexcept;
  ~OnCores();
  OnCores(const OnCores&) = delete;
  OnCores& operator=(const OnCores&) = delete;

 private:
  cpu_set_t before_;
  bool changed_;
};

}  // namespace aloft
