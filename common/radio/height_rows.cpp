#include "common/radio/height_rows.hpp"

#include "common/base/random.hpp"

// Every loop is compiled for several vector widths and chosen at run time. All give the same bits: each operation is
// rounded by itself, as IEEE 754 demands (no fused multiply-add, no reordering).
#if defined(__x86_64__)
#define ALOFT_WIDE_VECTORS [[gnu::target("avx2")]]
#if defined(__clang__)
#define ALOFT_WIDEST_VECTORS [[gnu::target("avx512f,avx512dq,avx512vl")]]
#else
#define ALOFT_WIDEST_VECTORS [[gnu::target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")]]
#endif
#endif

namespace aloft::radio {
namespace {

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

VectorWidth vector_width() noexcept {
  static const VectorWidth width = [] {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
      return VectorWidth::widest;
    return __builtin_cpu_supports("avx2") ? VectorWidth::wide : VectorWidth::baseline;
  }();
  return width;
}
#endif

/// Runs one of the loops below.
template <auto loop, typename... Arguments>
void run(Arguments... arguments) {
#ifdef ALOFT_WIDE_VECTORS
  if (vector_width() == VectorWidth::widest) return run_widest<loop>(arguments...);
  if (vector_width() == VectorWidth::wide) return run_wide<loop>(arguments...);
#endif
  loop(arguments...);
}

template <BsAntenna antenna, PathDistance path>
[[gnu::always_inline]] inline void power_segment(const RadioModel* model, double distance_m, const double* rise_m,
                                                 std::size_t size, double path_exponent, double* power_w) {
  if (path_exponent == 4.0) {  // the exponent known to the compiler: path_gain() without its branch
    for (std::size_t i = 0; i < size; ++i)
      power_w[i] = received_power_w<antenna, path>(*model, distance_m, rise_m[i], 4.0);
  } else {
    for (std::size_t i = 0; i < size; ++i)
      power_w[i] = received_power_w<antenna, path>(*model, distance_m, rise_m[i], path_exponent);
  }
}

[[gnu::always_inline]] inline void limits_loop(const RadioModel* model, double distance_m, const double* rise_m,
                                               std::size_t size, double* nearest_m, double* farthest_m) {
  for (std::size_t i = 0; i < size; ++i) {
    const BeamLimits limits = beam_limits(*model, distance_m, rise_m[i]);
    nearest_m[i] = limits.nearest_m;
    farthest_m[i] = limits.farthest_m;
  }
}

[[gnu::always_inline]] inline void exponential_loop(const std::uint32_t* words, std::size_t size, double* out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = -natural_log(unit_interval(words[i]));
}

[[gnu::always_inline]] inline void spectral_efficiency_loop(const double* sinr, std::size_t size, double* out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = spectral_efficiency(sinr[i]);
}

[[gnu::always_inline]] inline void decibel_loop(const double* sinr, std::size_t size, double* out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = decibel(sinr[i]);
}

[[gnu::always_inline]] inline void any_at_most_loop(const double* values, std::size_t size, double limit,
                                                    std::uint64_t* found) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < size; ++i) count += values[i] <= limit ? 1U : 0U;
  *found = count;
}

[[gnu::always_inline]] inline void disturbance_loop(double distance_m, const double* wanted, const double* nearest_m,
                                                    const double* farthest_m, std::size_t size, double* disturbs) {
  for (std::size_t i = 0; i < size; ++i) {
    const bool inside = BeamLimits{nearest_m[i], farthest_m[i]}.contain(distance_m);
    disturbs[i] = inside ? wanted[i] : 0.0;
  }
}

template <BsAntenna antenna, PathDistance path>
void power_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, std::uint32_t first_los,
               double* power_w) {
  run<power_segment<antenna, path>>(&model, distance_m, rise_m.data(), std::size_t{first_los}, model.path_exponent_nlos,
                                    power_w);
  run<power_segment<antenna, path>>(&model, distance_m, rise_m.data() + first_los, rise_m.size() - first_los,
                                    model.path_exponent_los, power_w + first_los);
}

}  // namespace

void received_power_row(const RadioModel& model, double distance_m, std::span<const double> rise_m,
                        std::uint32_t first_los, double* power_w) {
  const bool slant = model.path_distance == PathDistance::slant;
  if (model.bs_antenna == BsAntenna::array)
    (slant ? power_row<BsAntenna::array, PathDistance::slant>
           : power_row<BsAntenna::array, PathDistance::horizontal>)(model, distance_m, rise_m, first_los, power_w);
  else
    (slant ? power_row<BsAntenna::sector, PathDistance::slant>
           : power_row<BsAntenna::sector, PathDistance::horizontal>)(model, distance_m, rise_m, first_los, power_w);
}

void beam_limits_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, double* nearest_m,
                     double* farthest_m) {
  run<limits_loop>(&model, distance_m, rise_m.data(), rise_m.size(), nearest_m, farthest_m);
}

void disturbance_row(double distance_m, std::span<const double> wanted, const double* nearest_m,
                     const double* farthest_m, double* disturbs) {
  run<disturbance_loop>(distance_m, wanted.data(), nearest_m, farthest_m, wanted.size(), disturbs);
}

bool any_at_most(std::span<const double> values, double limit) {
  std::uint64_t found = 0;
  run<any_at_most_loop>(values.data(), values.size(), limit, &found);
  return found > 0;
}

void exponential_row(std::span<const std::uint32_t> words, double* out) {
  run<exponential_loop>(words.data(), words.size(), out);
}

void spectral_efficiency_row(std::span<const double> sinr, double* out) {
  run<spectral_efficiency_loop>(sinr.data(), sinr.size(), out);
}

void decibel_row(std::span<const double> sinr, double* out) {
  run<decibel_loop>(sinr.data(), sinr.size(), out);
}

}  // namespace aloft::radio
