#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/limits.hpp"
#include "common/base/parameters.hpp"
#include "common/radio/scene.hpp"

namespace aloft::radio {

/// How likely a report of the UAV's modem is, were the base stations at given positions. Line of sight everywhere, and
/// Rayleigh fading of every link, independent of the others (an approximation where a world's fading is another).
///
/// With p_c the power of cell c by the world's own link budget and k its interferers:
/// P(SINR_c > x) = exp(-N x / p_c) * product over k of 1 / (1 + x p_k / p_c). Cell c serves if no other candidate has a
/// better SINR. Neighbours are reported without their cells, so that all ways to assign cells to them are summed.
/// Densities are in u = log2(1 + x), and mixed with a little of a uniform one, for what the model lacks.
class ReportLikelihood {
 public:
  static constexpr std::uint32_t most_sinrs = limits::neighbours + 1;
  /// Cells that can be serving or neighbours: more than these, the strongest, are not looked at.
  static constexpr std::uint32_t most_compared = 8;

  /// What a report says: SINRs are linear, the serving cell's first, then those of the neighbours, descending.
  struct Report {
    world::Position place;
    double height_m = 0.0;
    std::uint32_t serving = 0;  ///< index into the sites
    std::uint32_t sinrs = 1;
    std::array<double, most_sinrs> sinr{};
  };

  /// A cell that can have been reported.
  struct Compared {
    std::uint32_t station = 0;
    bool stale = true;                         ///< the following is to be computed
    BeamLimits beam{};                         ///< of the UAV's antenna, pointed at it
    std::array<double, most_sinrs> density{};  ///< of its SINR, at each reported one
    double below_least = 0.0;                  ///< probability that its SINR is below the least reported
  };

  /// The stations as seen from a report's place, and what follows from it.
  struct Evaluation {
    bool ranked = false;
    std::uint32_t stronger = 0;  ///< stations with more power than the serving cell
    std::uint32_t compared_count = 0;
    std::array<Compared, most_compared> compared{};  ///< the serving cell, and the strongest of the others, descending
    double likelihood = 0.0;
  };
  struct View {
    Surroundings around;
    std::vector<double> power_w;
    Evaluation evaluation;
  };

  /// What a move of one station has changed in a view.
  struct Undo {
    Link link;
    std::uint8_t sector_covers = 0;
    double horizontal_loss_db = 0.0;
    double power_w = 0.0;
    bool evaluated = false;  ///< whether the evaluation has changed, too
    Evaluation evaluation;   ///< if so
  };

  /// `world`: every key of generated_world_parameters(). InputError if there are more sites than limits::base_stations.
  ReportLikelihood(const Parameters& world, const std::vector<world::Site>& sites);

  /// The view with the stations at these positions.
  void look(const Report& report, std::span<const world::Position> stations, View& into) const;
  /// The same view with one station elsewhere. What this does not change is not computed again.
  void move(const Report& report, std::uint32_t station, world::Position to, View& view, Undo& undo) const;
  /// Takes the last move back.
  static void take_back(const Undo& undo, std::uint32_t station, View& view);
  /// Whether the likelihood depends on this station's power: whether it is one of the compared, or interferes with one.
  [[nodiscard]] bool matters(const View& view, std::uint32_t station) const;

 private:
  void place(const Report& report, std::uint32_t station, world::Position at, View& view) const;
  [[nodiscard]] bool could_be_compared(const View& view, std::uint32_t station) const;
  void mark_stale(std::uint32_t station, View& view, Undo& undo) const;
  [[nodiscard]] bool interferes(const View& view, const Compared& with, std::uint32_t station) const;
  void evaluate(const Report& report, View& view) const;
  void rank(std::uint32_t serving, View& view) const;
  void compute(const Report& report, const View& view, Compared& cell) const;

  Scene scene_;
  std::uint32_t compared_;  // so many of the strongest
};

}  // namespace aloft::radio
