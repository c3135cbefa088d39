#include "tools/report/paper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/radio/generated_world.hpp"
#include "tools/report/published.hpp"

namespace aloft::report {
namespace {

using nlohmann::json;

/// Lists the keys whose values differ from `expected`: loss "cross-entropy" instead of "mse".
std::string differences(const json& here, const json& expected) {
  std::vector<std::string> found;
  for (const auto& [key, value] : expected.items())
    if (const json other = here.value(key, json()); other != value)
      found.push_back(fmt::format("{} {} instead of {}", key, other.dump(), value.dump()));
  return fmt::format("{}", fmt::join(found, ", "));
}

/// Compares all settings but the densities, which the paper varies, and the preset's name, which only repeats others.
std::string differences_of_world(json world) {
  world.emplace("spectral_efficiency_max", 0);  // as worlds that do not name it have it
  json expected = radio::resolve_generated_world(json::object(), "").to_json();
  for (const char* key : {"preset", "bs_density_per_km2", "building_density_per_km2"}) expected.erase(key);
  expected["spectral_efficiency_max"] = 0;
  return differences(world, expected);
}

std::string why_not_generated(const ConditionTrials& condition) {
  if (const std::string other = differences_of_world(condition.world_parameters); !other.empty())
    return "not the paper's world: " + other;
  const json& worlds = published().at("generated_worlds");
  if (std::ranges::none_of(worlds, [&](const json& world) { return belongs_to(world, condition); }))
    return fmt::format("the paper has no world with {:g} base stations and {:g} buildings per km²",
                       condition.bs_density_per_km2, condition.building_density_per_km2);
  return "";
}

std::string why_not_measured(const ConditionTrials& condition) {
  if (!papers_flight(condition).empty()) return "";
  std::vector<std::string> known;
  for (const auto& [name, flight] : published().at("measured_flights").items())
    known.push_back(flight.at("sha256").is_null()
                        ? fmt::format("that of {} is not known", name)
                        : fmt::format("{} is {:.8}…", name, flight["sha256"].get<std::string>()));
  return fmt::format("not a flight of the paper by its SHA-256, {:.8}… ({})",
                     condition.world_parameters.value("file_sha256", ""), fmt::join(known, ", "));
}

const std::vector<agents::AgentSpec>& definitions(std::string_view name) {
  static const auto all = [] {
    std::map<std::string, std::vector<agents::AgentSpec>, std::less<>> specs;
    for (const auto& [agent, facts] : published().at("agents").items())
      for (const json& entry : facts.at("is"))
        specs[agent].push_back(agents::parse_agents(entry, "published agent").front());
    return specs;
  }();
  const auto found = all.find(name);
  if (found == all.end()) throw std::logic_error(fmt::format("no published agent '{}'", name));
  return found->second;
}

bool same(const AgentTrials& agent, const agents::AgentSpec& definition) {
  return agent.type == definition.type && agent.parameters == definition.parameters.to_json();
}

/// Why the agent of this name is not the paper's; empty if there is no such agent.
std::string why_another(const ConditionTrials& condition, std::string_view name) {
  const agents::AgentSpec& first = definitions(name).front();
  for (const AgentTrials& agent : condition.agents)
    if (agent.name == name && !agent.trials.empty())
      return agent.type != first.type ? fmt::format("'{}' is of type {} here", name, agent.type)
                                      : fmt::format("'{}' is not the paper's: {}", name,
                                                    differences(agent.parameters, first.parameters.to_json()));
  return "";
}

std::string counted(std::size_t trials) {
  return fmt::format("{} trial{}, at least {} are needed", trials, trials == 1 ? "" : "s", least_trials());
}

/// The agents of `more` that `known` lacks or has fewer trials of.
void merge(ConditionTrials& known, const ConditionTrials& more) {
  for (const AgentTrials& agent : more.agents) {
    const auto same_name =
        std::ranges::find_if(known.agents, [&](const AgentTrials& other) { return other.name == agent.name; });
    if (same_name == known.agents.end())
      known.agents.push_back(agent);
    else if (same_name->trials.size() < agent.trials.size())
      *same_name = agent;
  }
}

}  // namespace

std::size_t least_trials() {
  return published().at("least_trials").get<std::size_t>();
}

std::string papers_flight(const ConditionTrials& condition) {
  if (condition.kind != experiment::WorldKind::measured) return "";
  for (const auto& [name, flight] : published().at("measured_flights").items())
    if (!flight.at("sha256").is_null() && flight["sha256"] == condition.world_parameters.value("file_sha256", ""))
      return name;
  return "";
}

std::string why_not_the_papers(const ConditionTrials& condition) {
  if (condition.costs.energy_weight != 0.0 || condition.costs.handover_cost != 0.0)
    return "not the paper's reward: energy_weight and handover_cost take something off";
  return condition.kind == experiment::WorldKind::generated ? why_not_generated(condition)
                                                            : why_not_measured(condition);
}

PapersAgent papers_agent(const ConditionTrials& condition, std::string_view name) {
  for (const agents::AgentSpec& definition : definitions(name))
    for (const AgentTrials& agent : condition.agents) {
      if (agent.trials.empty() || !same(agent, definition)) continue;
      const json& facts = published().at("agents").at(std::string(name));
      if (condition.kind == experiment::WorldKind::measured && facts.contains("differs_when_measured"))
        return {nullptr, fmt::format("'{}': {}", name, facts["differs_when_measured"].get<std::string>())};
      if (agent.trials.size() < least_trials())
        return {nullptr, fmt::format("'{}' has {}", name, counted(agent.trials.size()))};
      return {&agent};
    }
  return {nullptr, why_another(condition, name)};
}

PapersShare papers_share(std::span<const ConditionTrials> conditions) {
  PapersShare share;
  for (const ConditionTrials& condition : conditions) {
    const auto leave_out = [&](const std::string& why) {
      share.left_out.push_back(fmt::format("{}, {}: {}", condition.experiment, condition.label, why));
    };
    std::size_t most_trials = 0;
    for (const AgentTrials& agent : condition.agents) most_trials = std::max(most_trials, agent.trials.size());
    std::string why_not = why_not_the_papers(condition);
    if (why_not.empty() && most_trials < least_trials()) why_not = counted(most_trials);
    if (!why_not.empty()) {
      leave_out(why_not);
      continue;
    }
    ConditionTrials papers = condition;
    papers.agents.clear();
    for (const auto& [name, facts] : published().at("agents").items()) {
      const PapersAgent agent = papers_agent(condition, name);
      if (!agent.why_not.empty()) leave_out(agent.why_not);
      if (agent.trials == nullptr) continue;
      papers.agents.push_back(*agent.trials);
      papers.agents.back().name = name;
    }
    const auto known = std::ranges::find_if(
        share.conditions, [&](const ConditionTrials& other) { return other.world() == papers.world(); });
    if (known == share.conditions.end())
      share.conditions.push_back(std::move(papers));
    else
      merge(*known, papers);
  }
  return share;
}

}  // namespace aloft::report
