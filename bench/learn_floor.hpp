#pragma once

// Loops of multiply-adds alone: the most that a core can compute.
namespace bench_floor {

/// Multiply-add instructions of one call.
inline constexpr int chains = 12;  // more than latency times ports
inline constexpr long repetitions = 150'000;
inline constexpr double instructions_per_turn = static_cast<double>(chains) * repetitions;

void avx2_loop();    ///< 8 multiply-adds per instruction
void avx512_loop();  ///< 16

}  // namespace bench_floor
