#include "common/security/roles.hpp"

#include <string>

#include "common/base/error.hpp"

namespace aloft::security {

std::string_view to_text(Role role) noexcept {
  switch (role) {
    case Role::coordinator:
      return "coordinator";
    case Role::metrics:
      return "metrics";
    case Role::environment:
      return "environment";
    case Role::channel:
      return "channel";
    case Role::learning_agent:
      return "learning-agent";
    case Role::baseline_agent:
      return "baseline-agent";
    case Role::observer:
      return "observer";
    case Role::run_operator:
      return "operator";
  }
  return "unknown";
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
