#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/base/parameters.hpp"
#include "common/flight/energy.hpp"

namespace aloft::experiment {

enum class WorldKind : std::uint8_t { generated, measured };

/// One point of the sweep: a world whose parameters are all fixed.
struct Condition {
  std::uint32_t index = 0;
  /// The swept values, e.g. "bs_density_per_km2=2.5"; the world's own "name" or kind if nothing is swept.
  std::string name;
  nlohmann::json parameters;  ///< the swept values alone
  WorldKind kind = WorldKind::generated;
  Parameters world;  ///< table: generated_world_parameters() or measured_world_parameters()
};

/// What happens to a flight when its agent is lost.
enum class OnAgentLoss : std::uint8_t { restart, failover };

/// A fully resolved experiment. A trial is a pure function of (experiment, condition, trial index).
struct Experiment {
  std::string name;
  std::string description;
  std::uint64_t seed = 1;
  std::uint32_t trials = 0;  ///< per condition
  OnAgentLoss on_agent_loss = OnAgentLoss::restart;
  std::uint32_t max_attempts = 3;
  flight::Costs costs;  ///< except what is the world's, the step length and the handover: see costs_in
  std::vector<Condition> conditions;
  std::vector<agents::AgentSpec> agents;
  /// Canonical form: every default filled in, keys sorted. Parsing it again gives an equal experiment.
  nlohmann::json canonical;
  std::string id;  ///< 16 hexadecimal digits: hash of `canonical` without what cannot change a result (description,
                   ///< file paths; a file counts by its SHA-256)

  /// The costs of flights in this condition.
  [[nodiscard]] flight::Costs costs_in(const Condition& condition) const;
  [[nodiscard]] const agents::AgentSpec& agent(std::string_view agent_name) const;  ///< InputError if there is none
  /// Its place in `agents`; agents.size() if there is none of this name.
  [[nodiscard]] std::size_t agent_index(std::string_view agent_name) const noexcept;
};

/// Overrides given on the command line, applied in the order: set, then the others.
struct Overrides {
  std::vector<std::string> set{};     ///< "json.path=value"; the value is JSON, or else a text
  std::vector<std::string> agents{};  ///< replaces the file's agents if not empty
  std::optional<std::uint32_t> trials{};
  std::optional<std::uint64_t> seed{};
};

/// Reads, validates and resolves an experiment file. Throws InputError: file, line and column of a syntax error; JSON
/// path, value, allowed range and nearest valid key of a wrong entry. Relative paths in it count from its folder, those
/// in `overrides` from the working directory.
[[nodiscard]] Experiment load(const std::filesystem::path& file, const Overrides& overrides = {});

/// The same from a JSON text (a canonical form that came over the wire or out of a result folder).
[[nodiscard]] Experiment parse(std::string_view json, std::string_view where, const Overrides& overrides = {});

/// 0: the trials of a condition are independent. k: trial t is flown only after trial t - k is stored, because some
/// agents carry their memory from trial to trial (agents::AgentSpec::lineages); k is the greatest common divisor of
/// their numbers of lineages.
[[nodiscard]] std::uint32_t trial_lineages(const Experiment& experiment);

/// The place of a flight in its experiment.
struct FlightKey {
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
  std::string agent;
  auto operator<=>(const FlightKey&) const = default;
};

/// Identity of a flight on the wire: a hash of (experiment id, condition, trial, agent).
[[nodiscard]] std::uint64_t episode_id(const Experiment& experiment, const FlightKey& key);

}  // namespace aloft::experiment
