#pragma once

#include <cstdint>
#include <vector>

#include "common/agents/pretrained_state.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::train {

/// All reports of one world at the heights that single actions reach. Training flies through these.
struct Field {
  radio::QosKind kind = radio::QosKind::spectral_efficiency;
  std::uint32_t levels = 0;
  std::uint32_t steps = 0;
  std::uint32_t first_result = 0;                 ///< route point where the result of step 1 is read
  std::vector<agents::PretrainedReport> reports;  ///< [point * levels + level]

  [[nodiscard]] const agents::PretrainedReport& start() const { return reports.front(); }
  /// The report of `step`, 1..steps, at a level.
  [[nodiscard]] const agents::PretrainedReport& report(std::uint32_t step, std::uint32_t level) const {
    return reports[(step - 1 + first_result) * levels + level];
  }
};

[[nodiscard]] Field field_of(radio::SignalMap& map);

/// A generated city of preset `published` with 200 buildings per km2, like trial `trial` of an experiment.
[[nodiscard]] Field generated_field(double bs_density_per_km2, std::uint64_t seed, std::uint32_t trial);

/// A random throughput over heights and steps: a profile that falls with height, plus Gaussian fields that are
/// correlated over heights and constant or slowly changing over steps. Their strength differs between fields.
[[nodiscard]] Field random_throughput_field(std::uint64_t seed, std::uint32_t trial);

/// The discounted sum of future qualities on the best feasible flight: [step][level], steps 0 to steps (zero).
[[nodiscard]] std::vector<double> best_values(const Field& field, double discount);

}  // namespace aloft::train
