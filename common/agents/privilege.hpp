#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace aloft::agents {

/// What an agent knows beside the UAV's reports, in ascending order: nothing; the site map, as an operator has it;
/// foresight of quality, which nobody has. Each privilege has a row in privilege_tiers(), from which its names and
/// marks are made everywhere.
enum class Privilege : std::uint8_t { none, site_map, next_step, whole_route };

/// Whether an agent with this privilege is shown future quality (Agent::foresee).
[[nodiscard]] constexpr bool foresees(Privilege privilege) noexcept {
  return privilege >= Privilege::next_step;
}

/// The names and marks of a privilege.
struct PrivilegeTier {
  Privilege privilege = Privilege::none;
  std::string_view name;  ///< in files: "next-step"
  std::string_view mark;  ///< after the name of an agent in tables and charts; empty: no mark
  std::string_view sees;  ///< "the next step at every height"
};

/// All tiers, ascending.
[[nodiscard]] std::span<const PrivilegeTier> privilege_tiers() noexcept;
[[nodiscard]] const PrivilegeTier& privilege_tier(Privilege privilege);
/// The tier with this name in files; std::logic_error if there is none.
[[nodiscard]] const PrivilegeTier& privilege_tier(std::string_view name);

/// An agent's name as tables show it: "dqn", "planner **".
[[nodiscard]] std::string marked(std::string_view agent_name, const PrivilegeTier& tier);

/// What the marks of tables mean: "* sees the next step at every height, ** sees ...".
[[nodiscard]] std::string marks_explained();

}  // namespace aloft::agents
