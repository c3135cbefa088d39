#include "tools/train/rollout.hpp"

#include <algorithm>

#include "common/agents/pretrained_model.hpp"

namespace aloft::train {

using agents::PretrainedState;

Walker::Walker(const Field& field) : field_(&field), state_(field.kind, field.levels) {
  state_.observe(field.start());
}

std::uint32_t Walker::level_after(std::size_t action) const noexcept {
  const std::uint32_t k = level();
  if (action == 0) return k > 0 ? k - 1 : k;
  return action == 2 ? std::min(k + 1, field_->levels - 1) : k;
}

double Walker::fly(std::size_t action) {
  const agents::PretrainedReport& report = field_->report(++step_, level_after(action));
  state_.observe(report);
  return static_cast<double>(report.qos);
}

std::span<const std::size_t> GreedyPolicy::choose(std::span<const Walker> walkers) {
  inputs_.resize(walkers.size() * PretrainedState::inputs);
  outputs_.resize(walkers.size() * action_count);
  actions_.resize(walkers.size());
  for (std::size_t i = 0; i < walkers.size(); ++i)
    walkers[i].state().encode(
        std::span<float, PretrainedState::inputs>(&inputs_[i * PretrainedState::inputs], PretrainedState::inputs));
  network_.predict(inputs_, outputs_);
  for (std::size_t i = 0; i < walkers.size(); ++i)
    actions_[i] =
        agents::preferred_action(std::span<const float, action_count>(&outputs_[i * action_count], action_count));
  return actions_;
}

void Samples::add(const PretrainedState& state, const double (&values)[action_count]) {
  const std::size_t at = inputs.size();
  inputs.resize(at + PretrainedState::inputs);
  state.encode(std::span<float, PretrainedState::inputs>(&inputs[at], PretrainedState::inputs));
  const double mean = (values[0] + values[1] + values[2]) / 3.0;
  for (const double value : values) targets.push_back(static_cast<float>((value - mean) * double{state.scale()}));
}

void Samples::append(const Samples& more) {
  inputs.insert(inputs.end(), more.inputs.begin(), more.inputs.end());
  targets.insert(targets.end(), more.targets.begin(), more.targets.end());
}

std::vector<double> roll_out(std::span<const Walker> walkers, GreedyPolicy& policy, const RolloutSettings& settings) {
  std::vector<double> returns(walkers.size() * action_count, 0.0);
  std::vector<Walker> branches;
  std::vector<std::size_t> branch_of;
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    for (std::size_t action = 0; action < action_count; ++action) {
      branches.push_back(walkers[i]);
      branch_of.push_back(i * action_count + action);
      returns[branch_of.back()] = branches.back().fly(action);
    }
  }
  double weight = 1.0;
  for (std::uint32_t step = 1; step < settings.steps; ++step) {
    weight *= settings.discount;
    std::size_t kept = 0;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      if (branches[b].finished()) continue;
      if (kept != b) {
        branches[kept] = std::move(branches[b]);
        branch_of[kept] = branch_of[b];
      }
      ++kept;
    }
    branches.erase(branches.begin() + static_cast<std::ptrdiff_t>(kept), branches.end());
    branch_of.resize(kept);
    if (branches.empty()) break;
    const auto actions = policy.choose(branches);
    for (std::size_t b = 0; b < branches.size(); ++b) returns[branch_of[b]] += weight * branches[b].fly(actions[b]);
  }
  return returns;
}

}  // namespace aloft::train
