#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/agents/site_survey.hpp"
#include "common/agents/state_archive.hpp"
#include "common/base/random.hpp"
#include "common/radio/report_likelihood.hpp"

namespace aloft::agents {

/// A belief about where the base stations of a wrong map are: weighted maps that could be, the particles. At first they
/// are drawn around the stated positions with the stated error. Each report weighs them by its likelihood (a particle
/// filter: Gordon, Salmond, Smith 1993); when few maps have most of the weight, maps are drawn again by weight. Then
/// single sites are moved by the rule of Metropolis et al. 1953, given the last reports (Gilks, Berzuini 2001).
class SiteBelief {
 public:
  struct Settings {
    std::uint32_t particles = 1;
    std::uint32_t reports = 1;  ///< the last ones, which moves must fit
    std::uint32_t moves = 0;    ///< tried per particle after each report
  };
  struct Particle {
    std::vector<world::Position> stations;             ///< in the order of the map
    double weight = 0.0;                               ///< their sum is 1
    std::vector<radio::ReportLikelihood::View> views;  ///< of the last reports
  };

  /// The map must state an error. `stream`: all randomness there is.
  SiteBelief(const SiteSurvey& survey, const Settings& settings, const RandomStream& stream);

  [[nodiscard]] std::span<const Particle> particles() const noexcept { return particles_; }
  void learn(const radio::ReportLikelihood::Report& report);

  void save(StateWriter& writer) const;
  /// Of a belief with the same survey and settings. IntegrityError if it does not fit.
  void restore(const StateReader& reader);

 private:
  void weigh();
  void restore_reports(const StateReader& reader);
  void resample();
  [[nodiscard]] std::vector<std::size_t> draw();
  void list_movable(const Particle& particle);
  void try_move(Particle& particle, std::uint32_t station);
  [[nodiscard]] double squared_deviations(std::uint32_t station, world::Position position) const noexcept;

  std::vector<world::Site> sites_;
  double error_m_;
  Settings settings_;
  radio::ReportLikelihood likelihood_;
  RandomStream stream_;
  std::vector<radio::ReportLikelihood::Report> reports_;  // as many as views; the oldest is replaced
  std::uint64_t learnt_ = 0;
  std::vector<Particle> particles_;
  std::vector<std::uint32_t> movable_;               // scratch
  std::vector<radio::ReportLikelihood::Undo> undo_;  // scratch
};

}  // namespace aloft::agents
