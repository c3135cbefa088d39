#pragma once

#include <sched.h>

#include <filesystem>
#include <optional>

namespace aloft {

/// Cores this process may run on, at least 1: fewer than the machine has if the process is pinned to some, as Slurm and
/// taskset do, or has a quota, as containers and services have.
[[nodiscard]] unsigned usable_cores();

/// The CPU quota of this process's control groups in cores, rounded up; nothing if they set no limit.
/// `memberships` is laid out as /proc/self/cgroup, `hierarchies` as /sys/fs/cgroup (versions 1 and 2, cgroups(7)).
[[nodiscard]] std::optional<unsigned> quota_cores(const std::filesystem::path& memberships,
                                                  const std::filesystem::path& hierarchies);

/// One of several equal parts of the usable cores, counted from 0. With more parts than cores, some have the same core.
struct CoreShare {
  unsigned part = 0;
  unsigned of = 1;
};

/// While this object lives, this thread and the processes that it starts run only on their share of the cores.
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
