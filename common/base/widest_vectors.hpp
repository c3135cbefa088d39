#pragma once

#include <cstdint>

// Loops compiled for several vector widths and chosen at run time. All give the same bits: each operation is rounded by
// itself, as IEEE 754 requires, and none is reordered. Only std::fma becomes a fused multiply-add; the C library
// computes it on CPUs without that instruction. The file that uses these loops must be compiled with -O3.
#if defined(__x86_64__)
#define ALOFT_WIDE_VECTORS [[gnu::target("avx2,fma")]]
#if defined(__clang__)
#define ALOFT_WIDEST_VECTORS [[gnu::target("avx512f,avx512dq,avx512vl,fma")]]
#else
#define ALOFT_WIDEST_VECTORS [[gnu::target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")]]
#endif
#endif

namespace aloft {

#ifdef ALOFT_WIDE_VECTORS
template <auto loop, typename... Arguments>
ALOFT_WIDE_VECTORS void run_wide(Arguments... arguments) {
  loop(arguments...);
}

template <auto loop, typename... Arguments>
ALOFT_WIDEST_VECTORS void run_widest(Arguments... arguments) {
  loop(arguments...);
}

enum class VectorWidth : std::uint8_t { baseline, wide, widest };

inline VectorWidth vector_width() noexcept {
  static const VectorWidth width = [] {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
      return VectorWidth::widest;
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? VectorWidth::wide : VectorWidth::baseline;
  }();
  return width;
}
#endif

/// Runs `loop`, an always_inline function, with the widest vectors of this CPU.
template <auto loop, typename... Arguments>
void run_vectorised(Arguments... arguments) {
#ifdef ALOFT_WIDE_VECTORS
  if (vector_width() == VectorWidth::widest) return run_widest<loop>(arguments...);
  if (vector_width() == VectorWidth::wide) return run_wide<loop>(arguments...);
#endif
  loop(arguments...);
}

}  // namespace aloft
