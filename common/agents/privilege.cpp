#include "common/agents/privilege.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace aloft::agents {
namespace {

constexpr std::array tiers{
    PrivilegeTier{Privilege::none, "none", "", "what the UAV reports"},
    PrivilegeTier{Privilege::site_map, "site-map", "+", "the site map and the route ahead"},
    PrivilegeTier{Privilege::next_step, "next-step", "*", "the next step at every height"},
    PrivilegeTier{Privilege::whole_route, "whole-route", "**", "the whole route at every height"},
};

template <typename Condition>
const PrivilegeTier& first_tier(Condition condition) {
  const auto* const found = std::ranges::find_if(tiers, condition);
  if (found == tiers.end()) throw std::logic_error("a privilege without a tier");
  return *found;
}

}  // namespace

std::span<const PrivilegeTier> privilege_tiers() noexcept {
  return tiers;
}

const PrivilegeTier& privilege_tier(Privilege privilege) {
  return first_tier([&](const PrivilegeTier& tier) { return tier.privilege == privilege; });
}

const PrivilegeTier& privilege_tier(std::string_view name) {
  return first_tier([&](const PrivilegeTier& tier) { return tier.name == name; });
}

std::string marked(std::string_view agent_name, const PrivilegeTier& tier) {
  return fmt::format("{}{}{}", agent_name, tier.mark.empty() ? "" : " ", tier.mark);
}

std::string marks_explained() {
  std::string text;
  for (const PrivilegeTier& tier : tiers)
    if (!tier.mark.empty()) text += fmt::format("{}{} sees {}", text.empty() ? "" : ", ", tier.mark, tier.sees);
  return text;
}

}  // namespace aloft::agents
