#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace aloft::learn {

/// While this object lives, this thread's SIMD arithmetic treats denormal numbers as zero. Adam's
/// moments of units that are never active decay into denormals, and these more than double the time of training. Other
/// architectures than x86 neither need nor have this mode.
class FlushDenormals {
 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
#if defined(__SSE2__)
  FlushDenormals() noexcept : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero); }
  ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
  static constexpr unsigned flush_to_zero = 0x8000;
  static constexpr unsigned denormals_are_zero = 0x0040;
  unsigned saved_;
#else
  FlushDenormals() noexcept {}
  ~FlushDenormals() {}
#endif
};

}  // namespace aloft::learn
