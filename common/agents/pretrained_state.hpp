#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/agents/observation.hpp"

namespace aloft::agents {

/// The part of one report that the pre-trained network uses.
struct PretrainedReport {
  std::uint32_t level = 0;
  float qos = 0.0F;
  std::array<float, max_neighbours> se{};  ///< log2(1 + SINR) of the serving cell and its neighbours; 0: not reported
};

/// `level` is that of the observation's height.
[[nodiscard]] PretrainedReport pretrained_report(QosKind kind, std::uint32_t level, const Observation& observation);

/// The inputs of the pre-trained network: a function of the reports so far and nothing else.
///
/// Qualities are multiplied by s: 1/20 for spectral efficiency, 1 / (1.5 x mean of all qualities reported so far) for
/// throughput. In this order (k: present level, K: levels):
/// - for each offset -6..6 in levels: last quality reported there x s; SINR of the strongest neighbour reported there,
///   as log2(1 + SINR) x s; exp(-age/4); exp(-age/20) with age in steps; 1 if the level is inside the range, else 0.
///   All zero outside; the first four zero where the UAV has not been;
/// - the SINRs of the last report as log2(1 + SINR) x s: serving cell, then neighbours; missing ones are zero;
/// - k / 10; (K - 1 - k) / 10;
/// - for the last four steps, newest first: quality x s, change of level;
/// - mean quality x s; greatest quality x s / 2; min(steps, 200) / 100.
/// With throughput all SINRs are zero: measured worlds have no neighbours, and the serving SINR has no more
/// information than the throughput.
class PretrainedState {
 public:
  /// The version of this layout; every model is made for one layout.
  static constexpr std::uint32_t layout_version = 1;
  static constexpr std::size_t inputs = 83;
  static constexpr std::size_t history = 4;

  /// Everything that save and restore must keep.
  struct Memory {
    struct Level {
      float qos = 0.0F;
      float second_se = 0.0F;
      std::int32_t step = -1;  ///< of the last visit; -1: never
    };
    struct Past {
      float qos = 0.0F;
      float level_change = 0.0F;
    };
    std::vector<Level> levels;
    std::array<Past, history> past{};  ///< newest first
    std::array<float, max_neighbours> se{};
    std::int32_t steps = -1;  ///< reports so far, the one of step 0 not counted
    std::uint32_t level = 0;
    double qos_sum = 0.0;
    float qos_max = 0.0F;
  };

  PretrainedState() = default;
  PretrainedState(QosKind kind, std::uint32_t levels);

  void observe(const PretrainedReport& report);
  void encode(std::span<float, inputs> to) const;
  /// The factor s above.
  [[nodiscard]] float scale() const noexcept;

  [[nodiscard]] const Memory& memory() const noexcept { return memory_; }
  void restore(Memory memory) { memory_ = std::move(memory); }

 private:
  QosKind kind_ = QosKind::spectral_efficiency;
  Memory memory_;
};

}  // namespace aloft::agents
