#pragma once

#include <cstdint>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// What the paper's DQN makes of reports: its input vector and its reward.
///
/// The state, newest first: the reported SINRs (serving cell, then `neighbours` cells in descending order) and the
/// height; then for each of the last `history` steps the same values, the action taken there (-1 down, 0 hold, 1 up)
/// and the reward it brought. Generated worlds: 2 + neighbours + history (4 + neighbours) inputs, 38 as published;
/// measured flights have no neighbours: 18.
class DqnEncoder {
 public:
  enum class InputScaling {
    db,          ///< SINR in dB / 20
    linear_max,  ///< SINR as a power ratio / the largest seen so far
  };
  enum class Reward {
    absolute,    ///< bit/s/Hz, or Mbit/s
    scaled,      ///< / the largest seen so far
    difference,  ///< minus the reward of the step before
  };
  struct Settings {
    std::uint32_t neighbours = 4;
    std::uint32_t history = 4;
    InputScaling input_scaling = InputScaling::db;
    Reward reward = Reward::absolute;
  };

  explicit DqnEncoder(const Settings& settings) : settings_(settings) {}

  /// Fixes the layout and forgets the last flight's history; the largest values seen stay.
  void begin(const FlightInfo& flight);
  /// Forgets the largest values seen, too.
  void forget() noexcept;
  /// Reports must come in order. Throws InputError if there are too few neighbours for the layout.
  void observe(const Observation& observation);

  [[nodiscard]] std::size_t inputs() const noexcept;
  /// Whether `history` steps lie behind the latest report, so that state() exists.
  [[nodiscard]] bool complete() const noexcept { return moments_.size() > settings_.history; }
  /// No report of this flight yet.
  [[nodiscard]] bool empty() const noexcept { return moments_.empty(); }
  [[nodiscard]] std::vector<float> state() const;
  /// Of the latest step.
  [[nodiscard]] float reward() const;

  void save(StateWriter& writer) const;
  void restore(const StateReader& reader);

 private:
  /// One report, and what was done there once that is known.
  struct Moment {
    std::vector<double> sinr_db;
    double height = 0.0;  // 0..1 over the allowed range
    double height_m = 0.0;
    double action = 0.0;
    double reward = 0.0;  // bit/s/Hz or Mbit/s
    double gain = 0.0;    // reward minus that of the step before
  };
  static constexpr std::size_t moment_values = 5;  // without the SINRs

  [[nodiscard]] std::size_t sinrs() const noexcept;
  [[nodiscard]] double scaled_sinr(double sinr_db) const;
  [[nodiscard]] double scaled_reward(const Moment& moment) const;

  Settings settings_;
  FlightInfo flight_;
  std::vector<Moment> moments_;  // oldest first, at most history + 1
  double largest_sinr_ = 0.0;    // power ratio
  double largest_reward_ = 0.0;
};

}  // namespace aloft::agents
