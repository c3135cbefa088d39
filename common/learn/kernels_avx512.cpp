// The training kernels for AVX-512F. This file has its own compiler flags and no library headers (see kernels.hpp).

#include <immintrin.h>

#include "common/learn/kernels.hpp"

namespace aloft::learn {
namespace {

/// 16 floats in one register.
struct V {
  __m512 r;

  static V of(float x) { return {_mm512_set1_ps(x)}; }
  static V load(const float* p) { return {_mm512_load_ps(p)}; }
  static V broadcast(const float* p) { return {_mm512_set1_ps(*p)}; }
  void store(float* p) const { _mm512_store_ps(p, r); }
};

inline V add(V a, V b) {
  return {_mm512_add_ps(a.r, b.r)};
}
inline V sub(V a, V b) {
  return {_mm512_sub_ps(a.r, b.r)};
}
inline V mul(V a, V b) {
  return {_mm512_mul_ps(a.r, b.r)};
}
inline V div(V a, V b) {
  return {_mm512_div_ps(a.r, b.r)};
}
inline V root(V a) {
  return {_mm512_sqrt_ps(a.r)};
}
inline V min(V a, V b) {
  return {_mm512_min_ps(a.r, b.r)};
}
inline V max(V a, V b) {
  return {_mm512_max_ps(a.r, b.r)};
}
/// a b + c and c - a b, rounded once.
inline V fma(V a, V b, V c) {
  return {_mm512_fmadd_ps(a.r, b.r, c.r)};
}
inline V fnma(V a, V b, V c) {
  return {_mm512_fnmadd_ps(a.r, b.r, c.r)};
}

inline V where_positive(V x, V a, V b) {
  return {_mm512_mask_blend_ps(_mm512_cmp_ps_mask(x.r, _mm512_setzero_ps(), _CMP_GT_OQ), b.r, a.r)};
}
/// a where low <= x <= high, else 0; also 0 where x is not a number.
inline V where_between(V x, V low, V high, V a) {
  const __mmask16 inside = _mm512_cmp_ps_mask(x.r, low.r, _CMP_GE_OQ) & _mm512_cmp_ps_mask(x.r, high.r, _CMP_LE_OQ);
  return {_mm512_maskz_mov_ps(inside, a.r)};
}
inline bool any_positive(V x) {
  return _mm512_cmp_ps_mask(x.r, _mm512_setzero_ps(), _CMP_GT_OQ) != 0;
}
/// Bit s: lane s is not zero (or not a number).
inline unsigned nonzero(V x) {
  return _mm512_cmp_ps_mask(x.r, _mm512_setzero_ps(), _CMP_NEQ_UQ);
}
/// 2^n for whole numbers -126 <= n <= 127.
inline V power_of_two(V n) {
  const __m512i exponent = _mm512_add_epi32(_mm512_cvtps_epi32(n.r), _mm512_set1_epi32(127));
  return {_mm512_castsi512_ps(_mm512_slli_epi32(exponent, 23))};
}
inline V reciprocal_guess(V x) {
  return {_mm512_castsi512_ps(_mm512_sub_epi32(_mm512_set1_epi32(0x7EF311C7), _mm512_castps_si512(x.r)))};
}

/// 16 x 16 floats, rows `from_stride` and `to_stride` floats apart.
inline void transpose(const float* from, int from_stride, float* to, int to_stride) {
  __m512 a[16];
  __m512 b[16];
#pragma GCC unroll 16
  for (int i = 0; i < 16; ++i) a[i] = _mm512_load_ps(from + i * from_stride);
#pragma GCC unroll 8
  for (int i = 0; i < 16; i += 2) {
    b[i] = _mm512_unpacklo_ps(a[i], a[i + 1]);
    b[i + 1] = _mm512_unpackhi_ps(a[i], a[i + 1]);
  }
#pragma GCC unroll 4
  for (int i = 0; i < 16; i += 4) {  // a[i + c]: column c of each 4 x 4 block of rows i .. i + 3
    a[i] = _mm512_shuffle_ps(b[i], b[i + 2], 0x44);
    a[i + 1] = _mm512_shuffle_ps(b[i], b[i + 2], 0xEE);
    a[i + 2] = _mm512_shuffle_ps(b[i + 1], b[i + 3], 0x44);
    a[i + 3] = _mm512_shuffle_ps(b[i + 1], b[i + 3], 0xEE);
  }
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) {  // then transposes the 4 x 4 arrangement of blocks
    const __m512 even_top = _mm512_shuffle_f32x4(a[c], a[4 + c], 0x88);
    const __m512 odd_top = _mm512_shuffle_f32x4(a[c], a[4 + c], 0xDD);
    const __m512 even_bottom = _mm512_shuffle_f32x4(a[8 + c], a[12 + c], 0x88);
    const __m512 odd_bottom = _mm512_shuffle_f32x4(a[8 + c], a[12 + c], 0xDD);
    _mm512_store_ps(to + c * to_stride, _mm512_shuffle_f32x4(even_top, even_bottom, 0x88));
    _mm512_store_ps(to + (4 + c) * to_stride, _mm512_shuffle_f32x4(odd_top, odd_bottom, 0x88));
    _mm512_store_ps(to + (8 + c) * to_stride, _mm512_shuffle_f32x4(even_top, even_bottom, 0xDD));
    _mm512_store_ps(to + (12 + c) * to_stride, _mm512_shuffle_f32x4(odd_top, odd_bottom, 0xDD));
  }
}

// Tiles that fill the 32 registers.
constexpr int forward_outputs = 25;
constexpr int delta_blocks = 3;
constexpr int delta_samples = 8;
constexpr int gradient_blocks = 7;

#include "common/learn/kernel_source.hpp"

constexpr Kernels kernels{forward, train};

}  // namespace

const Kernels& avx512_kernels() {
  return kernels;
}

}  // namespace aloft::learn
