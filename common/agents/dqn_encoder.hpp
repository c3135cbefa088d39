#pragma once

#include <cstdint>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// Turns reports into the input vector and the reward of the paper's DQN.
///
/// The state, newest first: the reported SINRs (serving cell, then `neighbours` cells in descending order) and the
/// height; then for each of the last `history` steps the same values, the action taken then (-1 down, 0 hold, 1 up)
/// and its reward. Generated worlds: 2 + neighbours + history (4 + neighbours) inputs, 38 as published;
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

  /// Sets the layout for this flight and clears the history; the largest values seen are kept.
  void begin(const FlightInfo& flight);
  /// Resets the largest values seen.
  void forget() noexcept;
  /// Reports must come in order. Throws InputError if there are too few neighbours for the layout.
  void observe(const Observation& observation);

  [[nodiscard]] std::size_t inputs() const noexcept;
  /// Whether there are `history` steps before the latest report, which state() needs.
  [[nodiscard]] bool complete() const noexcept { return moments_.size() > settings_.history; }
  /// Whether there has been no report in this flight.
  [[nodiscard]] bool empty() const noexcept { return moments_.empty(); }
  [[nodiscard]] std::vector<float> state() const;
  /// The reward of the latest step.
  [[nodiscard]] float reward() const;

  void save(StateWriter& writer) const;
  void restore(const StateReader& reader);

 private:
  /// One report, with the action after it and its reward once they are known.
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
