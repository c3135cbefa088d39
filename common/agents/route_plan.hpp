#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// The best feasible flight through the quality that is expected at every level of the next steps, by dynamic
/// programming (Bellman).
class RoutePlan {
 public:
  /// Nothing is expected yet.
  explicit RoutePlan(std::size_t levels) : levels_(levels) {}

  [[nodiscard]] std::size_t levels() const noexcept { return levels_; }
  /// Expectations are known from this step on, for so many steps.
  [[nodiscard]] std::uint32_t first_step() const noexcept { return first_step_; }
  [[nodiscard]] std::size_t steps() const noexcept { return expected_.size() / levels_; }
  [[nodiscard]] bool covers(std::uint32_t step) const noexcept {
    return step >= first_step_ && step < first_step_ + steps();
  }

  /// [step - first_step()][level]
  [[nodiscard]] std::span<const double> expected() const noexcept { return expected_; }

  /// Expectations of earlier steps are no longer needed; later ones start at `step` if there are none so far.
  void forget_before(std::uint32_t step);
  /// [step][level], of the steps after those already known.
  void expect(std::span<const double> qualities);
  /// Replaces all expectations.
  void expect_instead(std::vector<double> qualities) { expected_ = std::move(qualities); }
  /// To be called after all expectations.
  void solve();
  /// [level]: the best sum of this step and all later ones.
  [[nodiscard]] std::span<const double> values(std::uint32_t step) const;
  /// The action for this step that begins the best flight from `level`; on ties hold, then down.
  [[nodiscard]] Action action(std::uint32_t step, std::uint32_t level) const;

  void save(StateWriter& writer) const;
  /// Of a flight with so many steps. IntegrityError if it cannot be.
  void restore(const StateReader& reader, std::uint32_t steps);

 private:
  std::size_t levels_;
  std::uint32_t first_step_ = 1;
  std::vector<double> expected_;  // [step - first_step_][level]
  std::vector<double> value_;     // the same with the best of what follows
};

}  // namespace aloft::agents
