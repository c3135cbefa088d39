#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "common/agents/registry.hpp"

/// Several agents in one flight: {"type": "relay", "name": "...", "crew": [{"agent": "min-height"}, {"agent": "dqn",
/// "from_step": 51}]}. Members aboard get every report and command every step; the pilot's command is executed.
namespace aloft::agents {

inline constexpr std::size_t max_crew = 8;

/// The parameters of a crew member's entry, besides "agent".
[[nodiscard]] std::span<const ParameterSpec> crew_parameters();

/// Removes "crew" from a relay's entry and reads it: at least two members, the first flies from step 1, the others from
/// steps that ascend. Throws InputError with the JSON path. Refuses privileged agents, which would need to foresee
/// quality in the middle of a flight, and agents that remember earlier flights.
[[nodiscard]] std::vector<CrewMember> take_crew(nlohmann::json& entry, bool named, std::string_view where);
[[nodiscard]] nlohmann::json crew_to_json(const std::vector<CrewMember>& crew);

/// Index of the member that flies `step` (1, 2, ...) if no agent fails and none is swapped in.
[[nodiscard]] std::size_t written_pilot(const std::vector<CrewMember>& crew, std::uint32_t step) noexcept;

}  // namespace aloft::agents
