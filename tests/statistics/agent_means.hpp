#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace aloft::statistics {

/// The densities of a condition in the table of expected means.
struct Densities {
  double bs_per_km2;
  double buildings_per_km2;
};

struct Sample {
  double mean = 0.0;
  double sd = 0.0;
  std::uint32_t trials = 0;

  /// Largest deviation of a mean over so many trials from the expected one: three standard errors + 0.1, which is the
  /// accuracy of the expected means.
  [[nodiscard]] double tolerance() const;
};

[[nodiscard]] Sample sample_of(std::span<const double> values);

/// Mean quality per flight, [agent][trial], of agents that fly the same generated worlds. Trials are shared out to two
/// threads; the result does not depend on that.
[[nodiscard]] std::vector<std::vector<double>> fly_trials(const nlohmann::json& world, const nlohmann::json& agents,
                                                          std::uint32_t trials);

/// The gain of an agent over min-height on the same worlds, printed.
[[nodiscard]] Sample gain_over_min_height(const nlohmann::json& agent, const nlohmann::json& world,
                                          std::uint32_t trials);
[[nodiscard]] nlohmann::json world_with(const Densities& densities);

/// Checks (Catch2) random-walk and one-step-ahead against the expected means, and the height filter's gain over
/// min-height against the expected gains where they are known.
void check_expected_means(const Densities& densities, std::uint32_t trials);

}  // namespace aloft::statistics
