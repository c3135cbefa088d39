#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// The spectral efficiency that is to be expected on each of several maps that could be, and how well each map explains
/// the last reports. Where the UAV is now, the maps that agree with its reports tell more than the others about the
/// heights and places nearby; what they say of far places is worth no more, so earlier reports are gradually forgotten.
class MapBelief {
 public:
  MapBelief(std::size_t maps, std::size_t levels) : maps_(maps), levels_(levels), log_weights_(maps, 0.0) {}

  /// Steps whose columns are known: from first_step() on, without gaps.
  [[nodiscard]] std::uint32_t first_step() const noexcept { return first_step_; }
  [[nodiscard]] std::size_t steps() const noexcept { return columns_.size(); }

  /// columns[map * levels + level], bit/s/Hz. Columns of earlier steps are forgotten if that of a step is left out.
  void expect(std::uint32_t step, std::vector<float> columns);
  void forget_before(std::uint32_t step);

  /// Weighs the maps by what was reported at a step; nothing happens if its columns are not known.
  void learn(std::uint32_t step, std::uint32_t level, double sinr_db);
  /// The mean over the maps by weight: [level] of each of `count` steps from `step` on, whose columns must be known.
  [[nodiscard]] std::vector<double> mean_columns(std::uint32_t step, std::size_t count) const;

  void save(StateWriter& writer) const;
  /// The weights; the columns are to be told again.
  void restore(const StateReader& reader);

 private:
  [[nodiscard]] std::vector<double> weights() const;

  std::size_t maps_;
  std::size_t levels_;
  std::uint32_t first_step_ = 1;
  std::deque<std::vector<float>> columns_;  // [step - first_step_][map * levels_ + level]
  std::vector<double> log_weights_;         // up to a constant
};

}  // namespace aloft::agents
