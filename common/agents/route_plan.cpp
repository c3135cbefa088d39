#include "common/agents/route_plan.hpp"

#include <algorithm>
#include <cmath>

namespace aloft::agents {

void RoutePlan::forget_before(std::uint32_t step) {
  const std::size_t past = std::min<std::size_t>(step - std::min(step, first_step_), steps());
  expected_.erase(expected_.begin(), expected_.begin() + static_cast<std::ptrdiff_t>(past * levels_));
  first_step_ = std::max(first_step_, step);
}

void RoutePlan::expect(std::span<const double> qualities) {
  expected_.insert(expected_.end(), qualities.begin(), qualities.end());
}

/// value_[i][k] = expected_[i][k] + the largest value_[i + 1] that is reachable from level k.
void RoutePlan::solve() {
  value_ = expected_;
  for (std::size_t i = steps(); i-- > 1;) {
    const double* next = value_.data() + i * levels_;
    double* now = value_.data() + (i - 1) * levels_;
    for (std::size_t k = 0; k < levels_; ++k)
      now[k] += *std::max_element(next + (k > 0 ? k - 1 : 0), next + std::min<std::size_t>(k + 2, levels_));
  }
}

std::span<const double> RoutePlan::values(std::uint32_t step) const {
  return std::span(value_).subspan((step - first_step_) * levels_, levels_);
}

Action RoutePlan::action(std::uint32_t step, std::uint32_t level) const {
  const std::span<const double> value = values(step);
  std::uint32_t best = level;
  if (level > 0 && value[level - 1] > value[best]) best = level - 1;
  if (level + 1 < levels_ && value[level + 1] > value[best]) best = level + 1;
  return best == level ? Action::hold : best < level ? Action::down : Action::up;
}

void RoutePlan::save(StateWriter& writer) const {
  writer.put_integer("first_step", first_step_);
  writer.put("expected", std::span(expected_));
}

void RoutePlan::restore(const StateReader& reader, std::uint32_t steps) {
  const auto expected = reader.doubles("expected");
  const std::uint64_t first_step = reader.integer("first_step");
  if (expected.size() % levels_ != 0 || first_step < 1 || first_step > std::uint64_t{steps} + 1 ||
      expected.size() / levels_ > steps + 1 - first_step)
    reader.refuse("its plan does not fit its flight");
  if (!std::ranges::all_of(expected, [](double value) { return std::isfinite(value); }))
    reader.refuse("its plan has a value that is not finite");
  expected_.assign(expected.begin(), expected.end());
  first_step_ = static_cast<std::uint32_t>(first_step);
  solve();
}

}  // namespace aloft::agents
