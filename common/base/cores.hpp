#pragma once

namespace aloft {

/// Cores this process may run on, at least 1: fewer than the machine has if the process is pinned to some, as Slurm,
/// containers and taskset do.
[[nodiscard]] unsigned usable_cores() noexcept;

}  // namespace aloft
