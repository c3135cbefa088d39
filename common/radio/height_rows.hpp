#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/radio/link_budget.hpp"

/// The formulas of link_budget.hpp over the heights of a column, in a file of their own with the compiler options of
/// vectorised loops. Each element has the same bits as the formula for that height.
namespace aloft::radio {

/// received_power_w() at every rise: `gain_to_power_w` holds the channel model's gains before and powers after.
void received_power_row(const RadioModel& model, double distance_m, double horizontal_loss_db,
                        std::span<const double> rise_m, double* gain_to_power_w);

/// Multiplies each gain by that of shadowing which is `deviations` standard deviations above its mean loss.
void shadow_row(double deviations, std::span<const double> deviation_db, double* gain);

/// beam_limits() at every rise.
void beam_limits_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, double* nearest_m,
                     double* farthest_m);

/// disturbs[i] = wanted[i] where the beam at height i covers this distance, else 0.
void disturbance_row(double distance_m, std::span<const double> wanted, const double* nearest_m,
                     const double* farthest_m, double* disturbs);

/// Ranks one more station by power, then index, at every height; `strongest_w` and `strongest` are
/// [rank][width] of powers and stations, in descending order. A station that is displaced from the last rank is lost.
void rank_station_row(std::uint32_t station, std::span<const double> power_w, std::size_t ranks, std::size_t width,
                      double* strongest_w, double* strongest, std::vector<double>& scratch);

/// The greatest of the first `ranks` rows of [rank][width] at every height, and its rank; the first of equal ones.
void best_row(std::span<const double> rows, std::size_t ranks, std::size_t width, std::span<double> best,
              double* rank_of_best);

/// out[i] = row[i], or -1 where left_out[i] is this rank.
void others_row(std::span<const double> row, std::uint32_t rank, const double* left_out, double* out);

/// Adds, in the order given, the disturbances by one station each at four heights: those of `blocks[b]`, from the
/// powers of the station over all heights, and from [b][4] of fading and of 1 where it disturbs, else 0.
void add_interference(std::span<const double* const> power_w, const double* disturbs, const double* fading,
                      const std::uint32_t* blocks, double* interference_w);

[[nodiscard]] bool any_at_most(std::span<const double> values, double limit);

/// An Exp(1) number from each random word, by inversion.
void exponential_row(std::span<const std::uint32_t> words, double* out);

void spectral_efficiency_row(std::span<const double> sinr, double most, double* out);
void decibel_row(std::span<const double> sinr, double* out);

}  // namespace aloft::radio
