#include "common/agents/map_belief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "common/base/widest_vectors.hpp"
#include "common/radio/approximations.hpp"

namespace aloft::agents {
namespace {

// The fading of the signal alone moves log2 of the SINR by this standard deviation: pi / (sqrt(6) ln 2), because ln f
// of Rayleigh fading has that of a Gumbel distribution.
constexpr double deviation_bits = 1.85;
// The likelihood, relative to the best, of a report that no map explains.
constexpr double unexplained = 0.02;
// Weight of the reports before against that of a new one. 0.7 to 0.9 were equally good on all worlds that were tried.
constexpr double memory = 0.8;
// Beyond it, logarithms of weights are not told apart.
constexpr double least_log_weight = -100.0;

double spectral_efficiency(double sinr_db) {
  constexpr double range_db = 1000.0;
  const double sinr = radio::power_of_ten(std::clamp(sinr_db, -range_db, range_db) / 10.0);
  return radio::natural_log(1.0 + sinr) / std::numbers::ln2;
}

/// sum[level] += the weighted columns of all maps.
[[gnu::always_inline]] inline void add_weighted(double* __restrict sum, const float* __restrict column,
                                                const double* __restrict weight, std::size_t maps, std::size_t levels) {
  for (std::size_t i = 0; i < maps; ++i, column += levels)
    for (std::size_t k = 0; k < levels; ++k) sum[k] += weight[i] * static_cast<double>(column[k]);
}

}  // namespace

void MapBelief::expect(std::uint32_t step, std::vector<float> columns) {
  if (step != first_step_ + columns_.size()) {
    columns_.clear();
    first_step_ = step;
  }
  columns_.push_back(std::move(columns));
}

void MapBelief::forget_before(std::uint32_t step) {
  for (; !columns_.empty() && first_step_ < step; ++first_step_) columns_.pop_front();
}

void MapBelief::learn(std::uint32_t step, std::uint32_t level, double sinr_db) {
  if (step < first_step_ || step >= first_step_ + columns_.size()) return;
  const std::vector<float>& columns = columns_[step - first_step_];
  const double reported = spectral_efficiency(sinr_db);
  for (std::size_t i = 0; i < maps_; ++i) {
    const double deviations = (reported - columns[i * levels_ + level]) / deviation_bits;
    const double likelihood =
        unexplained + radio::exp2(std::max(-0.5 * deviations * deviations / std::numbers::ln2, least_log_weight));
    log_weights_[i] = memory * log_weights_[i] + radio::natural_log(likelihood);
  }
}

std::vector<double> MapBelief::weights() const {
  const double largest = *std::ranges::max_element(log_weights_);
  std::vector<double> weights;
  double sum = 0.0;
  for (const double log_weight : log_weights_) {
    weights.push_back(radio::exp2(std::max(log_weight - largest, least_log_weight) / std::numbers::ln2));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<double> MapBelief::mean_columns(std::uint32_t step, std::size_t count) const {
  const std::vector<double> weight = weights();
  std::vector<double> mean(count * levels_, 0.0);
  for (std::size_t w = 0; w < count; ++w) {
    const std::vector<float>& columns = columns_[step - first_step_ + w];
    run_vectorised<add_weighted>(mean.data() + w * levels_, columns.data(), weight.data(), maps_, levels_);
  }
  return mean;
}

void MapBelief::save(StateWriter& writer) const {
  writer.put("map_weights", std::span<const double>(log_weights_));
}

void MapBelief::restore(const StateReader& reader) {
  reader.get("map_weights", std::span(log_weights_));
  if (!std::ranges::all_of(log_weights_, [](double weight) { return std::fabs(weight) < 1e6; }))
    reader.refuse("a weight of its maps is impossible");
}

}  // namespace aloft::agents
