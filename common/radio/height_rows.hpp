#pragma once

#include <cstdint>
#include <span>

#include "common/radio/link_budget.hpp"

/// Loops of link_budget.hpp over the heights of a column, in a file of their own because it is compiled for
/// vectorisation. Each element has the bits that the formula gives alone.
namespace aloft::radio {

/// Received power of one base station at every rise; line of sight from index `first_los` on.
void received_power_row(const RadioModel& model, double distance_m, std::span<const double> rise_m,
                        std::uint32_t first_los, double* power_w);

/// beam_limits() at every rise.
void beam_limits_row(const RadioModel& model, double distance_m, std::span<const double> rise_m, double* nearest_m,
                     double* farthest_m);

/// wanted[i] where the beam at i covers this distance, else 0.
void disturbance_row(double distance_m, std::span<const double> wanted, const double* nearest_m,
                     const double* farthest_m, double* disturbs);

[[nodiscard]] bool any_at_most(std::span<const double> values, double limit);

/// Exp(1) from each random word.
void exponential_row(std::span<const std::uint32_t> words, double* out);

void spectral_efficiency_row(std::span<const double> sinr, double* out);
void decibel_row(std::span<const double> sinr, double* out);

}  // namespace aloft::radio
