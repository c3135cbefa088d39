#include "tools/report/agent_list.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/digest.hpp"

namespace aloft::report {
namespace {

using agents::Look;

/// Looks for agents that register none. With the registered ones they make 24 that can be told apart.
const std::vector<Look>& spare_looks() {
  static const std::vector<Look> looks{
      {"", 0, "#8088ff", "#748aae", {6, 2}},       {"", 0, "#007479", "#5affff", {1, 0}},
      {"", 0, "#930092", "#ff69e0", {8, 2, 2, 2}}, {"", 0, "#8a5754", "#ffa496", {3, 2}},
      {"", 0, "#003680", "#316eca", {12, 4}},      {"", 0, "#590051", "#a551bd", {2, 4}},
      {"", 0, "#600000", "#c85124", {6, 2}},       {"", 0, "#0e0600", "#83622a", {14, 2, 4, 2}}};
  return looks;
}

/// Gives looks to agents without one, each look once before any is given twice: first the spare ones, then those of
/// registered agents that are not here.
class FreeLooks {
 public:
  explicit FreeLooks(const std::vector<const Look*>& taken) : all_(palette()) {
    for (const Look& look : all_)
      free_.push_back(std::ranges::none_of(taken, [&](const Look* other) { return other->light == look.light; }));
  }

  /// A name has a place of its own among the looks, and gets the next free one if another agent has that.
  Look take(std::string_view name) {
    const std::size_t spare = spare_looks().size();
    for (const std::size_t count : {spare, all_.size()}) {
      const std::size_t from = all_.size() - count;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = from + (sha256_id(name) + i) % count;
        if (!free_[at]) continue;
        free_[at] = false;
        Look look = all_[at];
        if (rounds_ > 0) look.dash = {rounds_, rounds_};
        return look;
      }
    }
    free_.assign(all_.size(), true);
    ++rounds_;
    return take(name);
  }

 private:
  std::vector<Look> all_;
  std::vector<bool> free_;
  int rounds_ = 0;  ///< how often every look has been given; lines of the same colour get other dashes
};

}  // namespace

std::vector<Look> palette() {
  std::vector<Look> looks;
  for (const agents::AgentType& type : agents::agent_types())
    looks.insert(looks.end(), type.looks.begin(), type.looks.end());
  std::ranges::stable_sort(looks, {}, &Look::rank);
  looks.insert(looks.end(), spare_looks().begin(), spare_looks().end());
  return looks;
}

std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions) {
  std::vector<const AgentTrials*> agents;
  for (const ConditionTrials& condition : conditions)
    for (const AgentTrials& agent : condition.agents)
      if (std::ranges::none_of(agents, [&](const auto* other) { return other->name == agent.name; }))
        agents.push_back(&agent);
  std::ranges::stable_sort(agents, [](const auto* a, const auto* b) { return shown_before(*a, *b); });
  return agents;
}

nlohmann::json agent_list(std::span<const ConditionTrials> conditions) {
  const std::vector<const AgentTrials*> agents = agents_of(conditions);
  std::vector<const Look*> registered;
  for (const AgentTrials* agent : agents)
    if (const Look* own = agents::agent_type(agent->type).look_of(agent->name); own != nullptr)
      registered.push_back(own);
  FreeLooks free(registered);
  nlohmann::json list = nlohmann::json::array();
  for (const AgentTrials* agent : agents) {
    const agents::AgentType& type = agents::agent_type(agent->type);
    const Look* own = type.look_of(agent->name);
    const Look look = own != nullptr ? *own : free.take(agent->name);
    list.push_back({{"name", agent->name},
                    {"type", agent->type},
                    {"learns", type.is_learner()},
                    {"privilege", agents::privilege_tier(agent->privilege).name},
                    {"colour", {{"light", look.light}, {"dark", look.dark}}},
                    {"dash", look.dash}});
  }
  return list;
}

nlohmann::json tier_list() {
  nlohmann::json list = nlohmann::json::array();
  for (const agents::PrivilegeTier& tier : agents::privilege_tiers()) {
    const bool foresees = agents::foresees(tier.privilege);
    list.push_back({{"name", tier.name},
                    {"mark", tier.mark},
                    {"sees", tier.sees},
                    {"knows", foresees            ? "foresight"
                              : tier.mark.empty() ? "own reports"
                                                  : "site map"},
                    {"shape", foresees            ? "hollow"
                              : tier.mark.empty() ? "full"
                                                  : "half"}});
  }
  return list;
}

}  // namespace aloft::report
