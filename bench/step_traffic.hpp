#pragma once

#include <cstddef>
#include <vector>

#include "bench/cache_levels.hpp"
#include "common/learn/network.hpp"

namespace bench {

/// What a gradient step on random minibatches moves between caches.
struct StepTraffic {
  std::size_t array_bytes = 0;          ///< weights and moments
  std::vector<std::size_t> bytes_from;  ///< [level]: read from it, because no nearer level has them
};

/// Counted by going through the lines of weights and moments in the order of the kernels (kernel_source.hpp), with
/// caches that keep what was used last. What is written comes back the same way and is not counted a second time.
[[nodiscard]] StepTraffic step_traffic(const aloft::learn::NetworkShape& shape, aloft::learn::Path path,
                                       const std::vector<CacheLevel>& levels);

}  // namespace bench
