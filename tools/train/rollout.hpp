#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/learn/network.hpp"
#include "tools/train/field.hpp"

namespace aloft::train {

inline constexpr std::size_t action_count = 3;  // down, hold, up

/// One UAV on its way through a field. Flights of many walkers advance together, so that the network works on batches.
class Walker {
 public:
  explicit Walker(const Field& field);

  [[nodiscard]] bool finished() const noexcept { return step_ == field_->steps; }
  [[nodiscard]] std::uint32_t step() const noexcept { return step_; }
  [[nodiscard]] std::uint32_t level() const noexcept { return state_.memory().level; }
  [[nodiscard]] const Field& field() const noexcept { return *field_; }
  [[nodiscard]] const agents::PretrainedState& state() const noexcept { return state_; }
  /// The level that an action leads to.
  [[nodiscard]] std::uint32_t level_after(std::size_t action) const noexcept;
  /// Flies one step; returns its quality.
  double fly(std::size_t action);

 private:
  const Field* field_;
  agents::PretrainedState state_;
  std::uint32_t step_ = 0;
};

/// Which action the network prefers, for many walkers at once. Keeps its memory between calls.
class GreedyPolicy {
 public:
  explicit GreedyPolicy(learn::Network& network) : network_(network) {}
  /// One action per walker, valid until the next call.
  std::span<const std::size_t> choose(std::span<const Walker> walkers);

 private:
  learn::Network& network_;
  std::vector<float> inputs_;
  std::vector<float> outputs_;
  std::vector<std::size_t> actions_;
};

/// Training data: states and the centred value of each action there.
struct Samples {
  std::vector<float> inputs;   ///< [sample][PretrainedState::inputs]
  std::vector<float> targets;  ///< [sample][action]

  [[nodiscard]] std::size_t size() const noexcept { return targets.size() / action_count; }
  /// Values in units of quality; targets are values x scale, minus their mean.
  void add(const agents::PretrainedState& state, const double (&values)[action_count]);
  void append(const Samples& more);
};

struct RolloutSettings {
  double discount = 0.94;
  std::uint32_t steps = 20;
};

/// The discounted sums of quality when `action` is followed by the policy: [walker][action].
[[nodiscard]] std::vector<double> roll_out(std::span<const Walker> walkers, GreedyPolicy& policy,
                                           const RolloutSettings& settings);

}  // namespace aloft::train
