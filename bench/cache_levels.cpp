#include "bench/cache_levels.hpp"

#include <unistd.h>

#include <algorithm>

#include "bench/shortest_turn.hpp"

namespace bench {
namespace {

constexpr int turns = 20;
constexpr std::size_t bytes_per_turn = std::size_t{4} << 20U;
constexpr std::size_t most_bytes = std::size_t{256} << 20U;  ///< more than caches hold for one core

/// What Adam does to moments: reads, multiplies, adds, writes. Compiled for AVX2, which every machine with kernels has.
__attribute__((target("avx2,fma"), optimize("O3"))) void sweep(float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] = values[i] * 0.999F + 0.001F;
}

double bytes_per_second(std::size_t bytes) {
  const std::size_t count = bytes / sizeof(float);
  std::vector<float> values(count, 1.0F);
  const std::size_t sweeps = std::max<std::size_t>(1, bytes_per_turn / bytes);
  double best_s = 1e9;
  for (int turn = 0; turn < turns; ++turn)
    shortest_turn(best_s, [&] {
      for (std::size_t i = 0; i < sweeps; ++i) sweep(values.data(), count);
    });
  return 2.0 * static_cast<double>(sweeps * count * sizeof(float)) / best_s;
}

/// Bytes of a cache by its name in sysconf; 0 if the machine has none.
std::size_t size_of(int name) {
  return static_cast<std::size_t>(std::max(0L, sysconf(name)));
}

}  // namespace

std::vector<CacheLevel> measure_cache_levels() {
  const std::size_t l1 = size_of(_SC_LEVEL1_DCACHE_SIZE);
  const std::size_t l2 = size_of(_SC_LEVEL2_CACHE_SIZE);
  const std::size_t l3 = size_of(_SC_LEVEL3_CACHE_SIZE);
  std::vector<CacheLevel> levels;
  if (l1 > 0) levels.push_back({"L1", l1, bytes_per_second(l1 / 2)});
  if (l2 > 0) levels.push_back({"L2", l2, bytes_per_second(l2 / 2)});
  if (l3 > 0) levels.push_back({"L3", l3, bytes_per_second(std::min(l3 / 4, 4 * l2))});
  levels.push_back({"memory", 0, bytes_per_second(most_bytes)});
  return levels;
}

}  // namespace bench
