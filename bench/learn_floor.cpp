#include "bench/learn_floor.hpp"

#include <immintrin.h>

namespace bench_floor {

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

}  // namespace bench_floor
