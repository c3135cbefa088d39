// The training kernels for AVX2 with FMA. It has its own compiler flags and no library headers: see kernels.hpp.

#include <immintrin.h>

#include "common/learn/kernels.hpp"

namespace aloft::learn {
namespace {

/// 16 floats in two registers.
struct V {
  __m256 r;
  __m256 s;

  static V of(float x) { return {_mm256_set1_ps(x), _mm256_set1_ps(x)}; }
  static V load(const float* p) { return {_mm256_load_ps(p), _mm256_load_ps(p + 8)}; }
  static V broadcast(const float* p) { return of(*p); }
  void store(float* p) const {
    _mm256_store_ps(p, r);
    _mm256_store_ps(p + 8, s);
  }
};

inline V add(V a, V b) {
  return {_mm256_add_ps(a.r, b.r), _mm256_add_ps(a.s, b.s)};
}
inline V sub(V a, V b) {
  return {_mm256_sub_ps(a.r, b.r), _mm256_sub_ps(a.s, b.s)};
}
inline V mul(V a, V b) {
  return {_mm256_mul_ps(a.r, b.r), _mm256_mul_ps(a.s, b.s)};
}
inline V div(V a, V b) {
  return {_mm256_div_ps(a.r, b.r), _mm256_div_ps(a.s, b.s)};
}
inline V root(V a) {
  return {_mm256_sqrt_ps(a.r), _mm256_sqrt_ps(a.s)};
}
inline V min(V a, V b) {
  return {_mm256_min_ps(a.r, b.r), _mm256_min_ps(a.s, b.s)};
}
inline V max(V a, V b) {
  return {_mm256_max_ps(a.r, b.r), _mm256_max_ps(a.s, b.s)};
}
/// a b + c and c - a b, rounded once.
inline V fma(V a, V b, V c) {
  return {_mm256_fmadd_ps(a.r, b.r, c.r), _mm256_fmadd_ps(a.s, b.s, c.s)};
}
inline V fnma(V a, V b, V c) {
  return {_mm256_fnmadd_ps(a.r, b.r, c.r), _mm256_fnmadd_ps(a.s, b.s, c.s)};
}

inline __m256 positive(__m256 x) {
  return _mm256_cmp_ps(x, _mm256_setzero_ps(), _CMP_GT_OQ);
}
inline V where_positive(V x, V a, V b) {
  return {_mm256_blendv_ps(b.r, a.r, positive(x.r)), _mm256_blendv_ps(b.s, a.s, positive(x.s))};
}
inline __m256 where_between(__m256 x, __m256 low, __m256 high, __m256 a) {
  return _mm256_and_ps(a, _mm256_and_ps(_mm256_cmp_ps(x, low, _CMP_GE_OQ), _mm256_cmp_ps(x, high, _CMP_LE_OQ)));
}
/// a where low <= x <= high, else 0; also 0 where x is not a number.
inline V where_between(V x, V low, V high, V a) {
  return {where_between(x.r, low.r, high.r, a.r), where_between(x.s, low.s, high.s, a.s)};
}
inline bool any_positive(V x) {
  return _mm256_movemask_ps(_mm256_or_ps(positive(x.r), positive(x.s))) != 0;
}
inline unsigned nonzero(__m256 x) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(x, _mm256_setzero_ps(), _CMP_NEQ_UQ)));
}
/// Bit s: lane s is not zero (or not a number).
inline unsigned nonzero(V x) {
  return nonzero(x.r) | nonzero(x.s) << 8;
}
inline __m256 power_of_two(__m256 n) {
  const __m256i exponent = _mm256_add_epi32(_mm256_cvtps_epi32(n), _mm256_set1_epi32(127));
  return _mm256_castsi256_ps(_mm256_slli_epi32(exponent, 23));
}
/// 2^n for whole numbers -126 <= n <= 127.
inline V power_of_two(V n) {
  return {power_of_two(n.r), power_of_two(n.s)};
}
inline __m256 reciprocal_guess(__m256 x) {
  return _mm256_castsi256_ps(_mm256_sub_epi32(_mm256_set1_epi32(0x7EF311C7), _mm256_castps_si256(x)));
}
inline V reciprocal_guess(V x) {
  return {reciprocal_guess(x.r), reciprocal_guess(x.s)};
}

inline void transpose8(const float* from, int from_stride, float* to, int to_stride) {
  __m256 a[8];
  __m256 b[8];
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) a[i] = _mm256_load_ps(from + i * from_stride);
#pragma GCC unroll 4
  for (int i = 0; i < 8; i += 2) {
    b[i] = _mm256_unpacklo_ps(a[i], a[i + 1]);
    b[i + 1] = _mm256_unpackhi_ps(a[i], a[i + 1]);
  }
#pragma GCC unroll 2
  for (int i = 0; i < 8; i += 4) {  // a[i + c]: column c of both 4 x 4 blocks of rows i .. i + 3
    a[i] = _mm256_shuffle_ps(b[i], b[i + 2], 0x44);
    a[i + 1] = _mm256_shuffle_ps(b[i], b[i + 2], 0xEE);
    a[i + 2] = _mm256_shuffle_ps(b[i + 1], b[i + 3], 0x44);
    a[i + 3] = _mm256_shuffle_ps(b[i + 1], b[i + 3], 0xEE);
  }
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) {
    _mm256_store_ps(to + c * to_stride, _mm256_permute2f128_ps(a[c], a[4 + c], 0x20));
    _mm256_store_ps(to + (4 + c) * to_stride, _mm256_permute2f128_ps(a[c], a[4 + c], 0x31));
  }
}

/// 16 x 16 floats, rows `from_stride` and `to_stride` floats apart.
inline void transpose(const float* from, int from_stride, float* to, int to_stride) {
  transpose8(from, from_stride, to, to_stride);
  transpose8(from + 8, from_stride, to + 8 * to_stride, to_stride);
  transpose8(from + 8 * from_stride, from_stride, to + 8, to_stride);
  transpose8(from + 8 * from_stride + 8, from_stride, to + 8 * to_stride + 8, to_stride);
}

// Tiles that fill the 16 registers.
constexpr int forward_outputs = 5;
constexpr int delta_blocks = 1;
constexpr int delta_samples = 4;
constexpr int gradient_blocks = 5;

#include "common/learn/kernel_source.hpp"

constexpr Kernels kernels{forward, train};

}  // namespace

const Kernels& avx2_kernels() {
  return kernels;
}

}  // namespace aloft::learn
