#include "common/agents/height_belief.hpp"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using aloft::agents::HeightBelief;
using aloft::agents::QualityPrior;

namespace {

constexpr int belief_levels = 4;
const QualityPrior believed{.mean = 0.5,
                            .slope = 0.04,
                            .common_sd = 0.3,
                            .profile_sd = 0.1,
                            .profile_range = 5.0,
                            .change_sd = 0.2,
                            .change_range = 1.5,
                            .persistence = 0.8,
                            .noise_sd = 0.05};

struct Measured {
  int time;
  int level;
  double quality;
};
const std::vector<Measured> measured_flight{{1, 0, 0.7}, {2, 1, 0.4}, {3, 2, 0.9},
                                            {4, 2, 0.8}, {5, 1, 0.1}, {6, 0, 0.6}};

/// Covariance of the quality of level i at time s with that of level j at time t, by the definition of the model.
double covariance(int i, int s, int j, int t) {
  const double distance = std::abs(i - j);
  const double constant =
      std::pow(believed.common_sd, 2) + std::pow(believed.profile_sd, 2) * std::exp(-distance / believed.profile_range);
  const double changing = std::pow(believed.change_sd, 2) * std::exp(-distance / believed.change_range);
  return constant + changing * std::pow(believed.persistence, std::abs(s - t));
}

double expected(int level) {
  return believed.mean - believed.slope * level;
}

struct Estimate {
  double mean;
  double sd;
};

/// The conditional distribution of a joint Gaussian given all measurements at once, without a filter.
Estimate condition(int level, int time) {
  const auto n = static_cast<Eigen::Index>(measured_flight.size());
  Eigen::MatrixXd measured(n, n);
  Eigen::VectorXd cross(n);
  Eigen::VectorXd error(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const Measured& one = measured_flight[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < n; ++b) {
      const Measured& other = measured_flight[static_cast<std::size_t>(b)];
      measured(a, b) = covariance(one.level, one.time, other.level, other.time);
    }
    measured(a, a) += believed.noise_sd * believed.noise_sd;
    cross(a) = covariance(level, time, one.level, one.time);
    error(a) = one.quality - expected(one.level);
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(measured);
  const double variance = covariance(level, time, level, time) - cross.dot(factor.solve(cross));
  return {expected(level) + cross.dot(factor.solve(error)), std::sqrt(variance)};
}

}  // namespace

TEST_CASE("the belief is the conditional of the joint Gaussian, for every level and step ahead") {
  HeightBelief belief(believed, belief_levels);
  for (const Measured& one : measured_flight) belief.update(static_cast<std::uint32_t>(one.level), one.quality);
  std::vector<double> mean(belief_levels);
  std::vector<double> optimistic(belief_levels);
  for (const int ahead : {0, 1, 2, 7}) {
    const double left = std::pow(believed.persistence, ahead);
    belief.outlook(left, 1.0, 0.0, mean);
    belief.outlook(left, 1.0, 1.0, optimistic);
    for (int level = 0; level < belief_levels; ++level) {
      INFO("level " << level << ", " << ahead << " steps ahead");
      const Estimate estimate = condition(level, 6 + ahead);
      const auto k = static_cast<std::size_t>(level);
      CHECK(mean[k] == Approx(estimate.mean).epsilon(1e-10));
      CHECK(optimistic[k] - mean[k] == Approx(estimate.sd).epsilon(1e-10));
    }
  }
}

TEST_CASE("the unit of the measurements can be given after the updates") {
  HeightBelief belief(believed, belief_levels);
  HeightBelief in_kbps(believed, belief_levels);
  for (const Measured& one : measured_flight) {
    belief.update(static_cast<std::uint32_t>(one.level), one.quality);
    in_kbps.update(static_cast<std::uint32_t>(one.level), one.quality * 40'000.0);
  }
  std::vector<double> a(belief_levels);
  std::vector<double> b(belief_levels);
  belief.outlook(0.5, 1.0, 1.3, a);
  in_kbps.outlook(0.5, 1.0 / 40'000.0, 1.3, b);
  for (std::size_t k = 0; k < belief_levels; ++k) CHECK(a[k] == Approx(b[k]).epsilon(1e-12));
}

TEST_CASE("before any measurement the belief is the prior") {
  const HeightBelief belief(believed, belief_levels);
  std::vector<double> optimistic(belief_levels);
  belief.outlook(0.8, 0.0, 2.0, optimistic);
  // By hand: variance 0.3^2 + 0.1^2 + 0.2^2 = 0.14 at every level and time.
  for (int level = 0; level < belief_levels; ++level)
    CHECK(optimistic[static_cast<std::size_t>(level)] == Approx(0.5 - 0.04 * level + 2.0 * std::sqrt(0.14)));
}
