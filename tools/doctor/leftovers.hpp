#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace aloft::doctor {

/// Files in shared memory that a process on Fast DDS left behind when it was killed.
struct Leftover {
  std::vector<std::filesystem::path> files;
  std::uint64_t bytes = 0;
};

/// The leftovers in `dir` (/dev/shm) of this user: files with Fast DDS's names whose lock no process holds and that no
/// process has mapped, as far as this user can read its maps. Files of other users and files without a lock are never
/// listed. Aloft itself uses no shared memory; programs beside it can.
[[nodiscard]] std::vector<Leftover> find_leftovers(const std::filesystem::path& dir);

/// Removes those whose lock is still free. Returns how many were removed.
std::size_t remove_leftovers(const std::vector<Leftover>& leftovers);

}  // namespace aloft::doctor
