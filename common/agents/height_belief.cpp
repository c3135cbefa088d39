#include "common/agents/height_belief.hpp"

#include <algorithm>
#include <cmath>

namespace aloft::agents {
namespace {

/// exp(-distance / range). The last bit of std::exp for double depends on the processor's instruction set; computed in
/// extended precision and then rounded, it is the same on all processors.
double correlation(Eigen::Index distance, double range) {
  return static_cast<double>(std::exp(-static_cast<long double>(distance) / static_cast<long double>(range)));
}

Eigen::MatrixXd covariance_over_levels(Eigen::Index levels, double sd, double range) {
  Eigen::MatrixXd covariance(levels, levels);
  for (Eigen::Index i = 0; i < levels; ++i)
    for (Eigen::Index j = 0; j < levels; ++j) covariance(i, j) = sd * sd * correlation(std::abs(i - j), range);
  return covariance;
}

/// The coefficients, column by column.
template <typename Matrix>
auto values(Matrix& matrix) {
  return std::span(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

}  // namespace

HeightBelief::HeightBelief(const QualityPrior& prior, std::uint32_t levels)
    : prior_(prior),
      levels_(levels),
      process_noise_(covariance_over_levels(levels_, prior.change_sd, prior.change_range)),
      covariance_(Eigen::MatrixXd::Zero(2 * levels_, 2 * levels_)),
      from_prior_(Eigen::VectorXd::Zero(2 * levels_)),
      from_data_(Eigen::VectorXd::Zero(2 * levels_)),
      with_measured_(2 * levels_) {
  covariance_.topLeftCorner(levels_, levels_) =
      covariance_over_levels(levels_, prior.profile_sd, prior.profile_range).array() +
      prior.common_sd * prior.common_sd;
  covariance_.bottomRightCorner(levels_, levels_) = process_noise_;
  for (Eigen::Index k = 0; k < levels_; ++k) from_prior_(k) = prior.mean - prior.slope * static_cast<double>(k);
  process_noise_ *= 1.0 - prior.persistence * prior.persistence;
}

void HeightBelief::update(std::uint32_t level, double measured) {
  const double rho = prior_.persistence;
  const auto k = static_cast<Eigen::Index>(level);
  const auto changing = Eigen::seqN(levels_, levels_);

  from_prior_(changing) *= rho;
  from_data_(changing) *= rho;
  covariance_.topRightCorner(levels_, levels_) *= rho;
  covariance_.bottomLeftCorner(levels_, levels_) *= rho;
  covariance_.bottomRightCorner(levels_, levels_) *= rho * rho;
  covariance_.bottomRightCorner(levels_, levels_) += process_noise_;

  with_measured_ = covariance_.col(k) + covariance_.col(levels_ + k);
  const double innovation_variance =
      with_measured_(k) + with_measured_(levels_ + k) + prior_.noise_sd * prior_.noise_sd;
  const double prior_error = 0.0 - (from_prior_(k) + from_prior_(levels_ + k));
  const double data_error = measured - (from_data_(k) + from_data_(levels_ + k));
  from_prior_ += with_measured_ * (prior_error / innovation_variance);
  from_data_ += with_measured_ * (data_error / innovation_variance);
  for (Eigen::Index j = 0; j < covariance_.cols(); ++j)
    covariance_.col(j) -= with_measured_ * (with_measured_(j) / innovation_variance);
}

void HeightBelief::outlook(double persistence, double per_unit, double optimism, std::span<double> into) const {
  const double change_variance = prior_.change_sd * prior_.change_sd;
  const double forgotten = (1.0 - persistence * persistence) * change_variance;
  for (Eigen::Index k = 0; k < levels_; ++k) {
    const Eigen::Index l = levels_ + k;
    const double constant = from_prior_(k) + per_unit * from_data_(k);
    const double change = from_prior_(l) + per_unit * from_data_(l);
    const double variance = covariance_(k, k) + 2.0 * persistence * covariance_(k, l) +
                            persistence * persistence * covariance_(l, l) + forgotten;
    into[static_cast<std::size_t>(k)] = constant + persistence * change + optimism * std::sqrt(std::max(variance, 0.0));
  }
}

void HeightBelief::save(StateWriter& writer) const {
  writer.put("belief.covariance", values(covariance_));
  writer.put("belief.from_prior", values(from_prior_));
  writer.put("belief.from_data", values(from_data_));
}

void HeightBelief::restore(const StateReader& reader) {
  reader.get("belief.covariance", values(covariance_));
  reader.get("belief.from_prior", values(from_prior_));
  reader.get("belief.from_data", values(from_data_));
}

}  // namespace aloft::agents
