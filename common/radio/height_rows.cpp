#include "common/radio/height_rows.hpp"

#include <algorithm>
#include <cstddef>

#include "common/base/random.hpp"
#include "common/base/widest_vectors.hpp"

namespace aloft::radio {
namespace {

template <BsAntenna antenna>
[[gnu::always_inline]] inline void power_loop(const RadioModel* model, double distance_m, double horizontal_loss_db,
                                              const double* rise_m, std::size_t size, double* gain_to_power_w) {
  for (std::size_t i = 0; i < size; ++i)
    gain_to_power_w[i] =
        received_power_w<antenna>(*model, distance_m, rise_m[i], horizontal_loss_db, gain_to_power_w[i]);
}

[[gnu::always_inline]] inline void shadow_loop(double deviations, const double* deviation_db, std::size_t size,
                                               double* gain) {
  for (std::size_t i = 0; i < size; ++i) gain[i] *= power_of_ten(-0.1 * (deviations * deviation_db[i]));
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

[[gnu::always_inline]] inline void spectral_efficiency_loop(const double* sinr, std::size_t size, double most,
                                                            double* out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = spectral_efficiency(sinr[i], most);
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

/// Inserts one more station at every height. A displaced station becomes `moving` and competes for the next rank.
[[gnu::always_inline]] inline void strongest_loop(std::size_t size, std::size_t ranks, std::size_t width,
                                                  double* strongest_w, double* strongest, double* moving_w,
                                                  double* moving) {
  for (std::size_t rank = 0; rank < ranks; ++rank, strongest_w += width, strongest += width) {
    for (std::size_t i = 0; i < size; ++i) {
      const double there_w = strongest_w[i];
      const double there = strongest[i];
      const double new_w = moving_w[i];
      const double new_one = moving[i];
      const bool better = (new_w > there_w) | ((new_w == there_w) & (new_one < there));
      strongest_w[i] = better ? new_w : there_w;
      strongest[i] = better ? new_one : there;
      moving_w[i] = better ? there_w : new_w;
      moving[i] = better ? there : new_one;
    }
  }
}

[[gnu::always_inline]] inline void best_loop(const double* rows, std::size_t ranks, std::size_t width, std::size_t size,
                                             double* best, double* rank_of_best) {
  for (std::size_t i = 0; i < size; ++i) {
    best[i] = rows[i];
    rank_of_best[i] = 0.0;
  }
  for (std::size_t rank = 1; rank < ranks; ++rank) {
    rows += width;
    for (std::size_t i = 0; i < size; ++i) {
      const bool better = rows[i] > best[i];
      rank_of_best[i] = better ? static_cast<double>(rank) : rank_of_best[i];
      best[i] = better ? rows[i] : best[i];
    }
  }
}

[[gnu::always_inline]] inline void others_loop(const double* row, double rank, const double* left_out, std::size_t size,
                                               double* out) {
  for (std::size_t i = 0; i < size; ++i) out[i] = left_out[i] == rank ? -1.0 : row[i];
}

/// Adds power x fading where a station disturbs; a block is four heights.
[[gnu::always_inline]] inline void interference_loop(const double* const* power_w, const double* disturbs,
                                                     const double* fading, const std::uint32_t* blocks,
                                                     std::size_t size, double* interference_w) {
  for (std::size_t b = 0; b < size; ++b) {
    const double* power = power_w[b] + std::size_t{4} * blocks[b];
    double* sum = interference_w + std::size_t{4} * blocks[b];
    for (std::size_t lane = 0; lane < 4; ++lane)
      sum[lane] += disturbs[4 * b + lane] * (power[lane] * fading[4 * b + lane]);
  }
}

}  // namespace

void received_power_row(const RadioModel& model, double distance_m, double horizontal_loss_db,
                        std::span<const double> rise_m, double* gain_to_power_w) {
  const auto run = [&]<BsAntenna antenna>() {
    run_vectorised<power_loop<antenna>>(&model, distance_m, horizontal_loss_db, rise_m.data(), rise_m.size(),
                                        gain_to_power_w);
  };
  switch (model.bs_antenna) {
    case BsAntenna::array:
      return run.template operator()<BsAntenna::array>();
    case BsAntenna::sector:
      return run.template operator()<BsAntenna::sector>();
    case BsAntenna::tr_38_901:
      return run.template operator()<BsAntenna::tr_38_901>();
  }
}

void shadow_row(double deviations, std::span<const double> deviation_db, double* gain) {
  run_vectorised<shadow_loop>(deviations, deviation_db.data(), deviation_db.size(), gain);
}

void beam_limits_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, double* nearest_m,
                     double* farthest_m) {
  run_vectorised<limits_loop>(&model, distance_m, rise_m.data(), rise_m.size(), nearest_m, farthest_m);
}

void disturbance_row(double distance_m, std::span<const double> wanted, const double* nearest_m,
                     const double* farthest_m, double* disturbs) {
  run_vectorised<disturbance_loop>(distance_m, wanted.data(), nearest_m, farthest_m, wanted.size(), disturbs);
}

void rank_station_row(std::uint32_t station, std::span<const double> power_w, std::size_t ranks, std::size_t width,
                      double* strongest_w, double* strongest, std::vector<double>& scratch) {
  if (ranks == 0) return;
  const double* const weakest_w = strongest_w + (ranks - 1) * width;
  std::size_t first = 0;  // usually a station is strong in a single range of heights
  std::size_t end = power_w.size();
  while (first < end && power_w[first] < weakest_w[first]) ++first;
  while (first < end && power_w[end - 1] < weakest_w[end - 1]) --end;
  const std::size_t size = end - first;
  scratch.resize(2 * size);
  std::copy_n(power_w.begin() + static_cast<std::ptrdiff_t>(first), size, scratch.begin());
  std::fill_n(scratch.begin() + static_cast<std::ptrdiff_t>(size), size, station);
  run_vectorised<strongest_loop>(size, ranks, width, strongest_w + first, strongest + first, scratch.data(),
                                 scratch.data() + size);
}

void best_row(std::span<const double> rows, std::size_t ranks, std::size_t width, std::span<double> best,
              double* rank_of_best) {
  run_vectorised<best_loop>(rows.data(), ranks, width, best.size(), best.data(), rank_of_best);
}

void others_row(std::span<const double> row, std::uint32_t rank, const double* left_out, double* out) {
  run_vectorised<others_loop>(row.data(), static_cast<double>(rank), left_out, row.size(), out);
}

void add_interference(std::span<const double* const> power_w, const double* disturbs, const double* fading,
                      const std::uint32_t* blocks, double* interference_w) {
  run_vectorised<interference_loop>(power_w.data(), disturbs, fading, blocks, power_w.size(), interference_w);
}

bool any_at_most(std::span<const double> values, double limit) {
  std::uint64_t found = 0;
  run_vectorised<any_at_most_loop>(values.data(), values.size(), limit, &found);
  return found > 0;
}

void exponential_row(std::span<const std::uint32_t> words, double* out) {
  run_vectorised<exponential_loop>(words.data(), words.size(), out);
}

void spectral_efficiency_row(std::span<const double> sinr, double most, double* out) {
  run_vectorised<spectral_efficiency_loop>(sinr.data(), sinr.size(), most, out);
}

void decibel_row(std::span<const double> sinr, double* out) {
  run_vectorised<decibel_loop>(sinr.data(), sinr.size(), out);
}

}  // namespace aloft::radio
