#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/radio/fading.hpp"
#include "common/radio/scene.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::radio {

/// Computes the readings over all heights at one ground position. Its working memory is reused between calls.
class ColumnBuilder {
 public:
  /// What is taken for granted instead of what the world has.
  struct Assumptions {
    bool line_of_sight = false;  ///< everywhere, whatever is in the way
    double undisturbed = 1.0;    ///< factor of a SINR without any interference
  };

  ColumnBuilder(const Scene& scene, const Fading& fading) : ColumnBuilder(scene, fading, Assumptions{}) {}
  ColumnBuilder(const Scene& scene, const Fading& fading, const Assumptions& assumed);

  [[nodiscard]] std::vector<Reading> build(std::uint32_t point, world::Position position);
  /// efficiency[i] = log2(1 + sum of the SINRs of all stations that can serve), at every height of the scene.
  void sum_candidates(std::uint32_t point, world::Position position, double* efficiency);

 private:
  /// A wanted SINR: that of the station with this rank by power at this height.
  struct Slot {
    std::uint32_t height;
    std::uint32_t rank;
  };

  void compute_sinrs(std::uint32_t point, world::Position position);
  void rank_strongest();
  void rank_all();
  [[nodiscard]] bool may_be_among_strongest(std::uint32_t k);
  void collect_slots();
  void compute_sinr(std::uint32_t point, std::uint32_t c);
  void select_blocks(std::uint32_t c);
  void add_interferer(std::uint32_t point, std::uint32_t c, std::uint32_t k);
  [[nodiscard]] std::vector<Reading> choose_serving();
  [[nodiscard]] std::uint32_t first_los(std::uint32_t k);
  [[nodiscard]] const double* power_w(std::uint32_t k);

  const Scene& scene_;
  Fading fading_;
  Assumptions assumed_;
  std::uint32_t heights_;
  std::uint32_t width_;  // heights_, rounded up to whole fading blocks: rows of all tables below
  std::uint32_t ranks_;
  std::vector<double> height_m_;
  std::vector<double> rise_m_;

  Surroundings around_;
  // Per base station, computed when first needed at this position.
  std::vector<std::optional<std::uint32_t>> first_los_;
  std::vector<std::vector<double>> power_w_;  // [station][height], before fading
  std::vector<std::uint8_t> power_known_;

  std::vector<std::uint32_t> by_distance_;
  std::vector<double> ranked_power_w_;  // [rank][height], descending
  std::vector<double>
      ranked_;  // [rank][height]: base station; double, so that vectors of powers and stations have equal lanes
  std::vector<double> moving_;            // scratch
  std::vector<double> sinr_;              // [rank][height], linear
  std::vector<double> serving_rank_;      // [height]
  std::vector<double> others_;            // [height]: the SINR of one rank, -1 at heights where that station serves
  std::vector<double> neighbour_ranks_;   // scratch
  std::vector<std::vector<Slot>> slots_;  // per base station
  std::vector<std::uint32_t> involved_;   // base stations with slots

  // For the station whose SINR is being computed: the blocks of four heights where it is wanted, and values there.
  std::vector<std::uint32_t> blocks_;
  std::vector<double> wanted_;  // 1 or 0
  std::vector<double> block_rise_m_;
  std::vector<double> nearest_m_;
  std::vector<double> farthest_m_;
  std::vector<double> interference_w_;  // [height]
  // For its interferers, one after the other: the blocks with at least one height where the interferer disturbs; its
  // powers over all heights; 1 or 0 per height of the block, followed by unused leftovers of longer rows.
  std::vector<std::uint32_t> disturbed_blocks_;
  std::vector<const double*> disturber_w_;
  std::vector<double> disturbs_;
};

}  // namespace aloft::radio
