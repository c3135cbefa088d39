#include "common/security/roles.hpp"

#include <bit>
#include <string>

#include "common/base/error.hpp"

namespace aloft::security {

std::string_view to_text(Role role) noexcept {
  static constexpr std::array<std::string_view, all_roles.size()> names{
      "coordinator", "metrics", "environment", "channel", "learning-agent", "baseline-agent", "observer", "operator"};
  return names[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(role)))];
}

Role role_from_text(std::string_view text) {
  std::string names;
  for (const Role role : all_roles) {
    if (text == to_text(role)) return role;
    names += (names.empty() ? "" : ", ") + std::string(to_text(role));
  }
  throw InputError("there is no role '" + std::string(text) + "'; roles: " + names);
}

}  // namespace aloft::security
