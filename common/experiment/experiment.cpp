#include "common/experiment/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "common/agents/load_plugin.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/limits.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/read_file.hpp"
#include "common/experiment/conditions.hpp"
#include "common/experiment/file_keys.hpp"
#include "common/experiment/file_paths.hpp"
#include "common/experiment/identity.hpp"
#include "common/experiment/relay_rules.hpp"
#include "common/experiment/set_value.hpp"
#include "common/experiment/world_parameters.hpp"

namespace aloft::experiment {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

void check_keys(const OrderedJson& document) {
  if (!document.is_object())
    throw InputError("{} is not an experiment; use an object with \"name\", \"trials\", \"world\" and \"agents\"",
                     excerpt(document.dump()));
  const std::vector<std::string> keys = file_keys();
  for (const auto& item : document.items())
    if (std::ranges::find(keys, item.key()) == keys.end())
      throw InputError("{}: unknown key.{} Valid keys: {}", excerpt(item.key()), did_you_mean(item.key(), keys),
                       fmt::join(keys, ", "));
  for (const char* key : {"name", "trials", "agents"})
    if (!document.contains(key)) throw InputError("\"{}\" is missing", key);
  for (const char* key : {"$schema", "build"})
    if (document.contains(key) && !document.at(key).is_string())
      throw InputError("{}: {} is not allowed; use a text", key, excerpt(document.at(key).dump()));
}

std::uint64_t seed_of(const OrderedJson& document) {
  const auto seed = document.find("seed");
  if (seed == document.end()) return default_seed;
  // Read as an integer: a double holds only 53 bits.
  if (!seed->is_number_integer() || (!seed->is_number_unsigned() && seed->get<std::int64_t>() < 0))
    throw InputError("seed: {} is not allowed; use a whole number from 0 to 18446744073709551615",
                     excerpt(seed->dump()));
  return seed->get<std::uint64_t>();
}

void check_name(const std::string& name) {
  const bool fine = std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
  if (name.empty() || name.size() > limits::name_bytes || !fine || name.front() == '.')
    throw InputError(
        "name: {} is not allowed; use 1 to {} letters, digits, '-', '_' and '.', because result "
        "folders are named after it",
        excerpt(Json(name).dump()), limits::name_bytes);
}

/// The entries that are plain parameters: name, trials, ...
void read_settings(const OrderedJson& document, Experiment& experiment) {
  Json given = Json::object();
  for (const ParameterSpec& spec : file_settings())
    if (document.contains(spec.name)) given[spec.name] = document.at(spec.name);
  const Parameters settings(file_settings(), given, "");
  experiment.name = settings.text("name");
  check_name(experiment.name);
  experiment.description = settings.text("description");
  experiment.trials = static_cast<std::uint32_t>(settings.integer("trials"));
  experiment.on_agent_loss = settings.text("on_agent_loss") == "restart" ? OnAgentLoss::restart : OnAgentLoss::failover;
  experiment.max_attempts = static_cast<std::uint32_t>(settings.integer("max_attempts"));
  experiment.costs.speed_m_per_s = settings.number("speed_m_per_s");
  experiment.costs.energy_weight = settings.number("energy_weight");
  experiment.costs.handover_cost = settings.number("handover_cost");
  experiment.costs.handover_loss = settings.number("handover_loss");
  experiment.costs.outage_threshold_db = settings.number("outage_threshold_db");
}

void check_count(std::size_t agents) {
  if (agents > limits::agents) throw InputError("agents: {} are too many; use at most {}", agents, limits::agents);
}

std::vector<agents::AgentSpec> agents_of(const OrderedJson& document) {
  const OrderedJson& list = document.at("agents");
  if (!list.is_array() || list.empty())
    throw InputError("agents: {} is not allowed; use a list of at least one agent", excerpt(list.dump()));
  check_count(list.size());
  std::vector<agents::AgentSpec> specs;
  std::map<std::string, std::size_t> entry_of;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (agents::AgentSpec& spec : agents::parse_agents(Json(list[i]), fmt::format("agents[{}]", i))) {
      const auto [other, is_new] = entry_of.emplace(spec.name, i);
      if (!is_new)
        throw InputError(
            "agents[{}]: an agent named \"{}\" stands already at agents[{}]; give one of them "
            "another \"name\"",
            i, spec.name, other->second);
      specs.push_back(std::move(spec));
    }
  return specs;
}

/// What --agents asks for: an agent of the file, or one of the registry that the file need not name.
std::vector<agents::AgentSpec> chosen_agents(const std::vector<agents::AgentSpec>& in_file,
                                             const std::vector<std::string>& names) {
  std::vector<agents::AgentSpec> chosen;
  for (const std::string& name : names) {
    const auto found = std::ranges::find_if(in_file, [&](const auto& spec) { return spec.name == name; });
    std::vector<agents::AgentSpec> specs =
        found != in_file.end() ? std::vector{*found} : agents::parse_agents(Json(name), "--agents");
    for (agents::AgentSpec& spec : specs) {
      if (std::ranges::any_of(chosen, [&](const auto& other) { return other.name == spec.name; }))
        throw InputError("--agents: '{}' stands twice; name it once", spec.name);
      chosen.push_back(std::move(spec));
    }
  }
  return chosen;
}

void check_agent(agents::AgentSpec& spec, const FileAccess& files) {
  const agents::AgentType& type = agents::agent_type(spec.type);
  if (type.foreign) return;
  if (!files.always_read && agents::plugin_of(type.name) != nullptr) return;  // results of an older build can be read
  const std::string& key = type.file_parameter;
  if (!key.empty() && !spec.parameters.text(key).empty()) {
    if (!files.always_read && !spec.parameters.text(key + "_sha256").empty()) return;
    Json given = spec.parameters.to_json();
    const std::filesystem::path file = locate(spec.parameters.text(key));
    given[key] = file.string();
    if (spec.parameters.text(key + "_sha256").empty()) given[key + "_sha256"] = sha256_hex(read_file(file));
    spec.parameters = Parameters(type.parameters, given, fmt::format("agent '{}'", spec.name));
  }
  (void)spec.make();
}

/// Makes each agent once, as a check: some parameters are wrong only together, and model files are read only here.
/// The path of such a file becomes absolute, and its SHA-256, which counts in the experiment's id, is filled in.
void check_agents(std::vector<agents::AgentSpec>& specs, const FileAccess& files) {
  check_count(specs.size());
  for (agents::AgentSpec& spec : specs) {
    if (spec.crew.empty()) check_agent(spec, files);
    for (agents::CrewMember& member : spec.crew) check_agent(member.agent, files);
  }
}

/// The first agent that needs the site map; empty: none.
std::string site_map_agent(const std::vector<agents::AgentSpec>& specs) {
  const auto found = std::ranges::find(specs, agents::Privilege::site_map, &agents::AgentSpec::privilege);
  return found == specs.end() ? "" : found->name;
}

/// An agent that plans the whole route, or has the site map, needs a route that does not depend on the flight.
void check_routes(const Experiment& experiment) {
  for (const Condition& condition : experiment.conditions) {
    if (condition.kind != WorldKind::generated || condition.world.text("route") != "serving") continue;
    for (const agents::AgentSpec& spec : experiment.agents)
      if (spec.privilege() == agents::Privilege::whole_route || spec.privilege() == agents::Privilege::site_map)
        throw InputError(
            "agent '{}' plans the whole route, but in condition \"{}\" route \"serving\" "
            "makes the route depend on the flight; use \"nearest\", or leave this agent out",
            spec.name, condition.name);
  }
}

/// How many neighbour cells an agent reads in a generated world: its parameter "neighbours", or 0 if it has none.
int needed_neighbours(const agents::AgentSpec& spec) {
  const std::vector<ParameterSpec>& table = agents::agent_type(spec.type).parameters;
  const bool has_any = std::ranges::any_of(table, [](const ParameterSpec& one) { return one.name == "neighbours"; });
  return has_any ? spec.parameters.integer("neighbours") : 0;
}

void check_neighbours(const Experiment& experiment) {
  const auto check = [&](const agents::AgentSpec& spec) {
    for (const Condition& condition : experiment.conditions)
      if (condition.kind == WorldKind::generated && needed_neighbours(spec) > condition.world.integer("neighbours"))
        throw InputError(
            "agent '{}' looks at {} neighbour cells, but in condition \"{}\" \"neighbours\" makes the UAV "
            "report {}; let the world report more, or lower the agent's \"neighbours\"",
            spec.name, needed_neighbours(spec), condition.name, condition.world.integer("neighbours"));
  };
  for (const agents::AgentSpec& spec : experiment.agents) {
    check(spec);
    for (const agents::CrewMember& member : spec.crew) check(member.agent);
  }
}

Json canonical_form(const Experiment& experiment) {
  Json worlds = Json::array();
  for (const Condition& condition : experiment.conditions) worlds.push_back(canonical_world(condition));
  Json agent_list = Json::array();
  for (const agents::AgentSpec& spec : experiment.agents) agent_list.push_back(spec.to_json());
  return {{"name", experiment.name},
          {"description", experiment.description},
          {"seed", experiment.seed},
          {"trials", experiment.trials},
          {"on_agent_loss", experiment.on_agent_loss == OnAgentLoss::restart ? "restart" : "failover"},
          {"max_attempts", experiment.max_attempts},
          {"speed_m_per_s", experiment.costs.speed_m_per_s},
          {"energy_weight", experiment.costs.energy_weight},
          {"handover_cost", experiment.costs.handover_cost},
          {"handover_loss", experiment.costs.handover_loss},
          {"outage_threshold_db", experiment.costs.outage_threshold_db},
          {"worlds", std::move(worlds)},
          {"agents", std::move(agent_list)}};
}

/// The resolved experiment travels to every process in one sample of at most this size.
void check_size(const Experiment& experiment) {
  const std::size_t bytes = experiment.canonical.dump().size();
  if (bytes > limits::experiment_bytes)
    throw InputError(
        "{} conditions and {} agents make {} bytes when resolved; at most {} are allowed, about "
        "1,000 conditions: spread the sweep over several experiments",
        experiment.conditions.size(), experiment.agents.size(), bytes, limits::experiment_bytes);
}

/// The coordinator keeps some 20 bytes of each trial.
void check_trials(const Experiment& experiment) {
  const std::uint64_t trials = std::uint64_t{experiment.trials} * experiment.conditions.size();
  if (trials > limits::trials)
    throw InputError(
        "{} conditions x {} trials = {} trials are too many; use at most {} in one experiment, and spread "
        "the others over several",
        experiment.conditions.size(), experiment.trials, trials, limits::trials);
}

void apply(OrderedJson& document, const Overrides& overrides) {
  for (const std::string& assignment : overrides.set) set_value(document, assignment);
  if (overrides.trials) document["trials"] = *overrides.trials;
  if (overrides.seed) document["seed"] = *overrides.seed;
}

Experiment resolve(OrderedJson document, const Overrides& overrides, const FileAccess& files) {
  if (document.is_object()) apply(document, overrides);
  check_keys(document);
  Experiment experiment;
  experiment.seed = seed_of(document);
  read_settings(document, experiment);
  experiment.agents = agents_of(document);
  if (!overrides.agents.empty()) experiment.agents = chosen_agents(experiment.agents, overrides.agents);
  check_agents(experiment.agents, files);
  experiment.conditions =
      expand_worlds(document, {.always_read = files.always_read, .site_map_agent = site_map_agent(experiment.agents)});
  check_trials(experiment);
  check_routes(experiment);
  check_relays(experiment);
  check_neighbours(experiment);
  experiment.canonical = canonical_form(experiment);
  check_size(experiment);
  experiment.id = id_of(experiment.canonical);
  return experiment;
}

Experiment parse_with(OrderedJson document, std::string_view where, const Overrides& overrides,
                      const FileAccess& files) {
  try {
    return resolve(std::move(document), overrides, files);
  } catch (const InputError& error) {
    throw InputError("{}: {}", where, error.what());
  }
}

}  // namespace

flight::Costs Experiment::costs_in(const Condition& condition) const {
  flight::Costs own = costs;
  if (condition.kind == WorldKind::measured) return own;
  own.step_length_m = condition.world.number("route_spacing_m");
  own.a3 = radio::a3_rules(condition.world);
  return own;
}

const agents::AgentSpec& Experiment::agent(std::string_view agent_name) const {
  std::vector<std::string> names;
  for (const agents::AgentSpec& spec : agents) {
    if (spec.name == agent_name) return spec;
    names.push_back(spec.name);
  }
  throw InputError("experiment '{}' has no agent '{}'.{} Its agents: {}", name, agent_name,
                   did_you_mean(agent_name, names), fmt::join(names, ", "));
}

std::size_t Experiment::agent_index(std::string_view agent_name) const noexcept {
  return static_cast<std::size_t>(std::ranges::find(agents, agent_name, &agents::AgentSpec::name) - agents.begin());
}

Experiment load(const std::filesystem::path& file, const Overrides& overrides) {
  OrderedJson document = parse_json(read_file(file), file.string());
  anchor_paths(document, std::filesystem::absolute(file).parent_path());
  return parse_with(std::move(document), file.string(), overrides, {.always_read = true});
}

Experiment parse(std::string_view json, std::string_view where, const Overrides& overrides) {
  return parse_with(parse_json(json, where), where, overrides, {.always_read = false});
}

std::uint32_t trial_lineages(const Experiment& experiment) {
  std::uint32_t lineages = 0;
  for (const agents::AgentSpec& spec : experiment.agents) lineages = std::gcd(lineages, spec.lineages());
  return lineages;
}

std::uint64_t episode_id(const Experiment& experiment, const FlightKey& key) {
  return sha256_id(fmt::format("{}/{}/{}/{}", experiment.id, key.condition, key.trial, key.agent));
}

}  // namespace aloft::experiment
