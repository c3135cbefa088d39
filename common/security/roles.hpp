#pragma once

#include <array>
#include <string_view>

namespace aloft::security {

/// What a process is for. In a secured run it decides which topics the process may write and read.
enum class Role : unsigned {
  coordinator = 1U << 0U,
  metrics = 1U << 1U,
  environment = 1U << 2U,
  channel = 1U << 3U,
  learning_agent = 1U << 4U,
  baseline_agent = 1U << 5U,
  observer = 1U << 6U,      ///< the command line: reads how runs go
  run_operator = 1U << 7U,  ///< the command line: orders swaps
};
inline constexpr std::array all_roles{Role::coordinator, Role::metrics,        Role::environment,
                                      Role::channel,     Role::learning_agent, Role::baseline_agent,
                                      Role::observer,    Role::run_operator};

/// "learning-agent"; the program of a role is "aloft-" and this.
[[nodiscard]] std::string_view to_text(Role role) noexcept;
/// InputError, listing all roles, if there is no such role.
[[nodiscard]] Role role_from_text(std::string_view text);

/// A set of roles.
struct Roles {
  unsigned bits = 0;

  constexpr Roles(Role role) noexcept : bits(static_cast<unsigned>(role)) {}  // NOLINT: one role is a set of one
  [[nodiscard]] constexpr bool contain(Role role) const noexcept { return (bits & static_cast<unsigned>(role)) != 0; }
};
[[nodiscard]] constexpr Roles operator|(Roles a, Roles b) noexcept {
  a.bits |= b.bits;
  return a;
}

}  // namespace aloft::security
