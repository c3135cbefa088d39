#pragma once

namespace bench_floor {

/// Multiply-adds per second of one core in a loop that does nothing else: the best of several runs of a few ms.
double avx2_multiply_adds_per_s();
double avx512_multiply_adds_per_s();

}  // namespace bench_floor
