#include "common/agents/pretrained_state.hpp"

#include <algorithm>
#include <cmath>

namespace aloft::agents {
namespace {

constexpr int reach = 6;  // levels below and above that are inputs
constexpr std::size_t max_age = 400;

float efficiency(double sinr_db) {
  return static_cast<float>(std::log2(1.0 + std::pow(10.0, sinr_db / 10.0)));
}

/// exp(-age / steps) for every age in the table; beyond it counts as zero.
std::array<float, max_age> fading_memory(double steps) {
  std::array<float, max_age> table{};
  for (std::size_t age = 0; age < max_age; ++age) table[age] = static_cast<float>(std::exp(-double(age) / steps));
  return table;
}

}  // namespace

PretrainedReport pretrained_report(QosKind kind, std::uint32_t level, const Observation& observation) {
  PretrainedReport report{level, static_cast<float>(observation.qos), {}};
  if (kind == QosKind::throughput) return report;
  report.se[0] = efficiency(observation.serving_sinr_db);
  const std::size_t neighbours = std::min<std::size_t>(observation.neighbour_count, report.se.size() - 1);
  for (std::size_t i = 0; i < neighbours; ++i) report.se[i + 1] = efficiency(observation.neighbour_sinr_db[i]);
  return report;
}

PretrainedState::PretrainedState(QosKind kind, std::uint32_t levels) : kind_(kind) {
  memory_.levels.resize(levels);
}

void PretrainedState::observe(const PretrainedReport& report) {
  Memory& m = memory_;
  const float change = m.steps < 0 ? 0.0F : static_cast<float>(report.level) - static_cast<float>(m.level);
  ++m.steps;
  if (m.steps > 0) {
    std::shift_right(m.past.begin(), m.past.end(), 1);
    m.past.front() = {report.qos, std::clamp(change, -1.0F, 1.0F)};
  }
  m.level = report.level;
  m.se = report.se;
  m.levels[report.level] = {report.qos, report.se[1], m.steps};
  m.qos_sum += static_cast<double>(report.qos);
  m.qos_max = std::max(m.qos_max, report.qos);
}

float PretrainedState::scale() const noexcept {
  if (kind_ == QosKind::spectral_efficiency) return 1.0F / 20.0F;
  return memory_.qos_sum > 0.0 ? static_cast<float>((memory_.steps + 1) / (1.5 * memory_.qos_sum)) : 0.0F;
}

void PretrainedState::encode(std::span<float, inputs> to) const {
  static const auto forget_soon = fading_memory(4.0);
  static const auto forget_late = fading_memory(20.0);
  const Memory& m = memory_;
  const float s = scale();
  std::ranges::fill(to, 0.0F);
  auto at = to.begin();
  const auto levels = static_cast<int>(m.levels.size());
  for (int offset = -reach; offset <= reach; ++offset, at += 5) {
    const int k = static_cast<int>(m.level) + offset;
    if (k < 0 || k >= levels) continue;
    at[4] = 1.0F;
    const Memory::Level& seen = m.levels[static_cast<std::size_t>(k)];
    if (seen.step < 0) continue;
    const auto age = static_cast<std::size_t>(m.steps - seen.step);
    at[0] = seen.qos * s;
    at[1] = seen.second_se * s;
    at[2] = age < max_age ? forget_soon[age] : 0.0F;
    at[3] = age < max_age ? forget_late[age] : 0.0F;
  }
  for (const float se : m.se) *at++ = se * s;
  *at++ = static_cast<float>(m.level) / 10.0F;
  *at++ = static_cast<float>(m.levels.size() - 1 - m.level) / 10.0F;
  for (const Memory::Past& past : m.past) {
    *at++ = past.qos * s;
    *at++ = past.level_change;
  }
  *at++ = m.steps < 0 ? 0.0F : static_cast<float>(m.qos_sum / (m.steps + 1)) * s;
  *at++ = m.qos_max * s / 2.0F;
  *at++ = static_cast<float>(std::clamp(m.steps, 0, 200)) / 100.0F;
}

}  // namespace aloft::agents
