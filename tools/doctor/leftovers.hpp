#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aloft::doctor {

/// Files in shared memory that a process on Fast DDS left behind when it was killed.
struct Leftover {
  std::vector<std::filesystem::path> files;
  std::uint64_t bytes = 0;
};

/// The leftovers in `dir` (/dev/shm) of this user: files by Fast DDS's names whose lock nobody holds, and which no
/// process whose maps this user may read has mapped. Files of other users, and those without a lock, are never listed.
/// Aloft itself uses no shared memory; programs beside it may.
[[nodiscard]] std::vector<Leftover> find_leftovers(const std::filesystem::path& dir);

/// Removes them, unless somebody has taken the lock meanwhile. Returns how many were removed.
std::size_t remove_leftovers(const std::vector<Leftover>& leftovers);

}  // namespace aloft::doctor
