#include "bench/learn_floor.hpp"

#include <immintrin.h>

#include <algorithm>
#include <chrono>

namespace bench_floor {
namespace {

constexpr int rounds = 20;
constexpr long repetitions = 200'000;
constexpr int chains = 12;  // more than latency times ports

template <typename Run>
double best_rate(double multiply_adds, Run run) {
  double best_s = 1e9;
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    run();
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return multiply_adds / best_s;
}

__attribute__((target("avx2,fma"))) void avx2_loop() {
  __m256 sums[chains];
  const __m256 factor = _mm256_set1_ps(0.999F);
  for (__m256& sum : sums) sum = factor;
  for (long i = 0; i < repetitions; ++i) {
#pragma GCC unroll 12
    for (__m256& sum : sums) sum = _mm256_fmadd_ps(sum, factor, factor);
#pragma GCC unroll 12
    for (__m256& sum : sums) asm volatile("" : "+x"(sum));
  }
}

__attribute__((target("avx512f"))) void avx512_loop() {
  __m512 sums[chains];
  const __m512 factor = _mm512_set1_ps(0.999F);
  for (__m512& sum : sums) sum = factor;
  for (long i = 0; i < repetitions; ++i) {
#pragma GCC unroll 12
    for (__m512& sum : sums) sum = _mm512_fmadd_ps(sum, factor, factor);
#pragma GCC unroll 12
    for (__m512& sum : sums) asm volatile("" : "+v"(sum));
  }
}

}  // namespace

double avx2_multiply_adds_per_s() {
  return best_rate(8.0 * chains * repetitions, avx2_loop);
}
double avx512_multiply_adds_per_s() {
  return best_rate(16.0 * chains * repetitions, avx512_loop);
}

}  // namespace bench_floor
