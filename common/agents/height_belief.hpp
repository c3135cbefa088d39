#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// The prior distribution of quality, in a unit that the user of the belief chooses. Levels of height are numbered from
/// 0 at Zmin; i and j are two of them.
struct QualityPrior {
  double mean = 0.0;           ///< of level 0
  double slope = 0.0;          ///< decrease of the mean from each level to the next higher one
  double common_sd = 0.0;      ///< of the constant part that all levels share
  double profile_sd = 0.0;     ///< of each level's own constant part; Cov = profile_sd^2 exp(-|i - j| / profile_range)
  double profile_range = 1.0;  ///< levels
  double change_sd = 0.0;      ///< of the part that changes; Cov = change_sd^2 exp(-|i - j| / change_range)
  double change_range = 1.0;   ///< levels
  double persistence = 0.0;    ///< correlation of the part that changes from step to step
  double noise_sd = 0.0;       ///< of a measurement
};

/// A Kalman filter (Kalman 1960) over the quality of every height: f_k = p_k + l_k, p constant over the flight, l
/// first-order autoregressive. States are ordered p_0..p_(K-1), l_0..l_(K-1).
///
/// The unit u of the measurements can change later (it can be the mean of all rewards so far). The filter is linear, so
/// the mean is kept in two parts with the same gains, the contribution of the prior and that of the data: the belief in
/// units of u is prior + data / u.
class HeightBelief {
 public:
  HeightBelief(const QualityPrior& prior, std::uint32_t levels);

  [[nodiscard]] std::uint32_t levels() const noexcept { return static_cast<std::uint32_t>(levels_); }

  /// Predicts one step ahead, then corrects with the quality `measured` at `level`.
  void update(std::uint32_t level, double measured);

  /// For every level, mean + optimism x standard deviation of its quality i steps after the last update, where
  /// `persistence` is QualityPrior::persistence to the power of i. `per_unit` is 1 / u.
  void outlook(double persistence, double per_unit, double optimism, std::span<double> into) const;

  void save(StateWriter& writer) const;
  void restore(const StateReader& reader);

 private:
  QualityPrior prior_;
  Eigen::Index levels_;
  Eigen::MatrixXd process_noise_;  // of l, per step
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd from_prior_;
  Eigen::VectorXd from_data_;
  Eigen::VectorXd with_measured_;  // covariance of the states with the measured quality
};

}  // namespace aloft::agents
