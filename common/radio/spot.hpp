#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/radio/fading.hpp"
#include "common/radio/scene.hpp"
#include "common/radio/signal_map.hpp"
#include "common/radio/station_rows.hpp"

namespace aloft::radio {

/// Computes the reading at one place and height: what ColumnBuilder gives for that height, to the bit. The steps and
/// the formulas are the same; the loops run over base stations instead of heights. Its working memory is reused between
/// calls.
class SpotBuilder {
 public:
  SpotBuilder(const Scene& scene, const Fading& fading);

  [[nodiscard]] Reading build(std::uint32_t point, world::Position position, std::uint32_t height);
  /// As SignalMap::scan().
  void scan(std::uint32_t point, world::Position position, std::uint32_t height, std::span<const std::int32_t> also,
            CellScan& into);

 private:
  void look(world::Position position, std::uint32_t height);
  void compute_powers(world::Position position, std::uint32_t height);
  void rank_strongest(std::uint32_t count);
  void add_rank(std::int32_t cell);
  void find_interferers(double rise_m);
  void compute_sinrs(std::uint32_t point, std::uint32_t height);
  [[nodiscard]] Reading choose_serving();

  const Scene& scene_;
  Fading fading_;
  StationRows rows_;
  // Per base station:
  std::vector<double> covers_;           // 1 if its sector covers the UAV, else 0
  std::vector<double> power_w_;          // before fading
  std::vector<double> blocked_power_w_;  // scratch
  std::vector<double> disturbs_;         // 1 if it is in the UAV's beam towards the candidate, else 0
  // Per rank by power:
  std::vector<std::uint32_t> ranked_;  // base stations
  std::vector<std::size_t> links_;     // the end of its links in pairs_
  std::vector<double> sinr_;           // linear
  std::vector<std::uint32_t> pairs_;   // of each ranked station with itself and with its interferers, ascending
  std::vector<double> reported_;       // SINRs: serving cell, neighbours
};

}  // namespace aloft::radio
