#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace bench {

/// A place where data can lie, from the nearest to the core outwards.
struct CacheLevel {
  std::string name;               ///< "L1", "L2", "L3", "memory"
  std::size_t bytes = 0;          ///< its size; 0: memory
  double bytes_per_second = 0.0;  ///< read and written, in a loop that multiplies and adds in place
};

/// The data caches that a core of this machine sees, as the C library knows them, and memory. Bandwidth is measured
/// over half of L1 and L2, four times L2 for L3, which other cores use, too, and 256 MiB for memory. Takes a second.
[[nodiscard]] std::vector<CacheLevel> measure_cache_levels();

}  // namespace bench
