#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace aloft::agents {

/// How much of the future an agent sees, in ascending order. Each privilege has a row in privilege_tiers(), from which
/// its names and marks are made everywhere.
enum class Privilege : std::uint8_t { none, next_step, whole_route };

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
