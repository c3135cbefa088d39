#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/agent.hpp"
#include "common/agents/look.hpp"
#include "common/agents/privilege.hpp"
#include "common/base/parameters.hpp"

namespace aloft::agents {

/// The process of a worker that flies an agent.
enum class Host : std::uint8_t { baseline_agent, learning_agent };

/// Facts about one type of agent.
struct AgentType {
  std::string name;           ///< as in experiment files, e.g. "one-step-ahead"
  std::string description{};  ///< one sentence
  Privilege privilege = Privilege::none;
  bool unconstrained = false;  ///< may command Action::absolute
  bool learns = false;         ///< whether it learns in flight
  bool foreign = false;  ///< flown by a program of the user's over DDS: every instance needs a name, and make throws
  bool trained_beforehand = false;  ///< on training_worlds; on other worlds it can do worse
  std::optional<Host> host{};       ///< unset: the learning agent's if it learns, else the baseline agent's
  int rank = default_rank;          ///< order in tables and charts of agents that have no look
  std::vector<Look> looks{};  ///< for agents with these names; others get the palette's colours in order of appearance
  /// If set, this parameter is the path of a file that the agent reads, and "PARAMETER_sha256" is that file's digest,
  /// which is filled in when an experiment is resolved.
  std::string file_parameter{};
  bool relay = false;            ///< a crew of other agents in one flight: every instance needs a name, and make throws
  std::string name_parameter{};  ///< if set, "type-VALUE" is an instance name that sets it (constant-120); empty: none
  std::vector<ParameterSpec> parameters{};
  std::function<std::unique_ptr<Agent>(const Parameters&)> make{};
  /// The origin of data that are built into the agent, for people; unset: there are none.
  std::function<nlohmann::json()> provenance{};
  /// For types that can remember earlier flights, see AgentSpec::lineages. Unset: no flight has memory of another.
  std::function<std::uint32_t(const Parameters&)> lineages{};

  [[nodiscard]] Host hosted_by() const noexcept {
    return host.value_or(learns ? Host::learning_agent : Host::baseline_agent);
  }
  /// Whether it has learned, in flight or before.
  [[nodiscard]] bool is_learner() const noexcept { return learns || trained_beforehand; }
  /// The look of the agent with this name, if its type sets one.
  [[nodiscard]] const Look* look_of(std::string_view agent) const noexcept;
  [[nodiscard]] int rank_of(std::string_view agent) const noexcept;
};

/// Called once per agent file, at namespace scope: `const bool dqn_registered = register_agent({...});`
bool register_agent(AgentType type);

/// All types, sorted by name.
[[nodiscard]] std::span<const AgentType> agent_types();
/// The type with this name. Throws InputError with the nearest valid name.
[[nodiscard]] const AgentType& agent_type(std::string_view name);

struct CrewMember;

/// One agent of an experiment: its unique name, its type, its checked parameters.
struct AgentSpec {
  std::string name;  ///< e.g. "constant-120"
  std::string type;  ///< e.g. "constant"
  Parameters parameters;
  std::vector<CrewMember> crew;  ///< of a relay, else empty: see relay.hpp

  /// Throws std::logic_error for a relay, whose members are made one by one.
  [[nodiscard]] std::unique_ptr<Agent> make() const;
  /// As an entry of an experiment file that gives back the same agent.
  [[nodiscard]] nlohmann::json to_json() const;
  /// The privilege of the type; for a relay the highest of its crew, for a foreign agent the one in the experiment.
  [[nodiscard]] Privilege privilege() const;
  /// 0: no flight has memory of another. k: the agent that flies trial t starts with the memory (Agent::save_state)
  /// with which it ended trial t - k of the same condition: k independent chains of flights.
  [[nodiscard]] std::uint32_t lineages() const;
  /// The trial whose memory the agent starts with; nothing if it starts without memory.
  [[nodiscard]] std::optional<std::uint32_t> remembered_trial(std::uint32_t trial) const;
};

/// One of the agents that share the flights of a relay.
struct CrewMember {
  AgentSpec agent;
  std::uint32_t from_step = 0;  ///< the first step that it flies; 0: it is a standby
  bool shadow = true;  ///< comes aboard before the first step and follows the flight; else it comes for its first step

  /// The step of its first report if no agent fails; nothing if it never comes aboard.
  [[nodiscard]] std::optional<std::uint32_t> boards_at() const noexcept {
    if (shadow) return 0;
    return from_step > 0 ? std::optional(from_step - 1) : std::nullopt;
  }
};

/// 1 to 64 characters of a-z, 0-9, '.' and '-'.
[[nodiscard]] bool is_agent_name(std::string_view text) noexcept;

/// From an experiment file's entry: "min-height", "constant-120", {"type": "dqn", "loss": "cross-entropy", "name":
/// "dqn-ce"}. A list as a parameter's value makes one agent per value, named type-value (several lists: every
/// combination, values in the order of their keys). Names satisfy is_agent_name(). `where` is the JSON
/// path for errors (InputError).
[[nodiscard]] std::vector<AgentSpec> parse_agents(const nlohmann::json& entry, std::string_view where);

}  // namespace aloft::agents
