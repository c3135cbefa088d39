#include "common/agents/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/agents/relay.hpp"
#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::agents {
namespace {

using Json = nlohmann::json;

/// Every agent's file adds its own entry while the program starts, in any order.
std::vector<AgentType>& registered_types() {
  static std::vector<AgentType> types;
  return types;
}

const AgentType* find_type(std::string_view name) {
  for (const AgentType& type : registered_types())
    if (type.name == name) return &type;
  return nullptr;
}

[[noreturn]] void refuse_unknown(std::string_view name, std::string_view where) {
  std::vector<std::string> names;
  for (const AgentType& type : registered_types()) names.push_back(type.name);
  throw InputError("{}{}unknown agent '{}'.{} Valid agents: {}", where, where.empty() ? "" : ": ", excerpt(name),
                   did_you_mean(name, names), fmt::join(names, ", "));
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
}

void check_characters(const std::string& name, std::string_view where) {
  if (!is_agent_name(name))
    throw InputError("{}: agent name \"{}\" is not allowed; use 1 to {} characters of a-z, 0-9, '.', '-'", where,
                     excerpt(name), limits::name_bytes);
}

void check_name(const std::string& name, const AgentType& type, std::string_view where) {
  check_characters(name, where);
  const AgentType* other = find_type(name);
  if (other != nullptr && other != &type)
    throw InputError(
        "{}: agent name \"{}\" is not allowed for an agent of type '{}', because it is the "
        "name of another type; use another name",
        where, name, type.name);
}

/// A parameter's value as part of an instance name: 120, 0.5, cross-entropy.
std::string name_part(const Json& value) {
  std::string part = value.is_string()   ? value.get<std::string>()
                     : value.is_number() ? fmt::format("{}", value.get<double>())
                                         : value.dump();
  for (char& c : part) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!is_name_character(c)) c = '-';
  }
  return part;
}

/// "constant-120" is short for {"type": "constant", "height_m": 120}.
Json expand_short_form(const std::string& text, std::string_view where) {
  if (find_type(text) != nullptr) return {{"type", text}};
  for (const AgentType& type : registered_types()) {
    if (type.name_parameter.empty() || !text.starts_with(type.name + '-')) continue;
    const auto value = number_in<double>(std::string_view(text).substr(type.name.size() + 1));
    if (!value)
      throw InputError("{}: \"{}\" is not allowed; after \"{}-\" write a number for {}", where, excerpt(text),
                       type.name, type.name_parameter);
    return {{"type", type.name}, {"name", text}, {type.name_parameter, *value}};
  }
  refuse_unknown(text, where);
}

std::string take_text(Json& object, const char* key, std::string_view where) {
  const auto entry = object.find(key);
  if (entry == object.end()) return {};
  if (!entry->is_string()) throw InputError("{}.{}: {} is not allowed; use a text", where, key, excerpt(entry->dump()));
  auto text = entry->get<std::string>();
  object.erase(entry);
  return text;
}

struct Variant {
  std::string name;
  Json parameters;
};

/// Refuses too many combinations of the values in lists before any of them is made.
void check_combinations(const Json& given, std::string_view where) {
  double combinations = 1;  // can exceed the range of integers
  for (const auto& value : given)
    if (value.is_array()) combinations *= static_cast<double>(value.size());
  if (combinations > static_cast<double>(limits::agents))
    throw InputError(
        "{}: its lists make {:.15g} combinations, but an experiment has at most {} agents; list fewer "
        "values, or make several experiments",
        where, combinations, limits::agents);
}

/// One variant per combination of the values in lists.
std::vector<Variant> expand_lists(const Json& given, const std::string& name, bool name_given, const AgentType& type,
                                  std::string_view where) {
  check_combinations(given, where);
  std::vector<Variant> variants{{name, Json::object()}};
  for (const auto& [key, value] : given.items()) {
    const bool in_name = value.is_array() || (key == type.name_parameter && !name_given);
    const Json values = value.is_array() ? value : Json::array({value});
    if (values.empty()) throw InputError("{}.{}: [] is not allowed; list at least one value", where, excerpt(key));
    std::vector<Variant> next;
    for (const Variant& variant : variants) {
      for (const Json& one : values) {
        next.push_back(variant);
        next.back().parameters[key] = one;
        if (in_name) next.back().name += '-' + name_part(one);
      }
    }
    variants = std::move(next);
  }
  return variants;
}

}  // namespace

bool is_agent_name(std::string_view text) noexcept {
  return !text.empty() && text.size() <= limits::name_bytes && std::ranges::all_of(text, is_name_character);
}

const Look* AgentType::look_of(std::string_view agent) const noexcept {
  const auto look = std::ranges::find(looks, agent, &Look::agent);
  return look == looks.end() ? nullptr : &*look;
}

int AgentType::rank_of(std::string_view agent) const noexcept {
  const Look* look = look_of(agent);
  return look == nullptr ? rank : look->rank;
}

bool register_agent(AgentType type) {
  auto& types = registered_types();
  const auto at = std::ranges::lower_bound(types, type.name, {}, &AgentType::name);
  if (at != types.end() && at->name == type.name)
    throw std::logic_error(fmt::format("two agents register as '{}'", type.name));
  types.insert(at, std::move(type));
  return true;
}

std::span<const AgentType> agent_types() {
  return registered_types();
}

const AgentType& agent_type(std::string_view name) {
  const AgentType* type = find_type(name);
  if (type == nullptr) refuse_unknown(name, "");
  return *type;
}

std::unique_ptr<Agent> AgentSpec::make() const {
  return agent_type(type).make(parameters);
}

Json AgentSpec::to_json() const {
  Json entry = parameters.to_json();
  entry["name"] = name;
  entry["type"] = type;
  if (!crew.empty()) entry["crew"] = crew_to_json(crew);
  return entry;
}

Privilege AgentSpec::privilege() const {
  const AgentType& facts = agent_type(type);
  if (facts.foreign) return privilege_tier(parameters.text("privilege")).privilege;
  Privilege highest = facts.privilege;
  for (const CrewMember& member : crew) highest = std::max(highest, member.agent.privilege());
  return highest;
}

std::uint32_t AgentSpec::lineages() const {
  const AgentType& facts = agent_type(type);
  return facts.lineages ? facts.lineages(parameters) : 0;
}

std::optional<std::uint32_t> AgentSpec::remembered_trial(std::uint32_t trial) const {
  const std::uint32_t chains = lineages();
  return chains > 0 && trial >= chains ? std::optional(trial - chains) : std::nullopt;
}

std::vector<AgentSpec> parse_agents(const Json& entry, std::string_view where) {
  Json object = entry.is_string() ? expand_short_form(entry.get<std::string>(), where) : entry;
  if (!object.is_object() || !object.contains("type"))
    throw InputError(
        "{}: {} is not allowed; use an agent's name, or an object with \"type\", optional "
        "\"name\" and parameters",
        where, excerpt(entry.dump()));
  const std::string type_name = take_text(object, "type", where);
  const AgentType* type = find_type(type_name);
  if (type == nullptr) refuse_unknown(type_name, fmt::format("{}.type", where));
  const bool name_given = object.contains("name");
  const std::string name = name_given ? take_text(object, "name", where) : type->name;
  check_characters(name, where);  // before values that are swept become a part of it
  if (type->foreign && !name_given)
    throw InputError(
        "{}: an agent of type '{}' needs \"name\": the name under which the foreign program "
        "sends its commands",
        where, type->name);
  std::vector<CrewMember> crew;
  if (type->relay) crew = take_crew(object, name_given, where);
  std::vector<AgentSpec> specs;
  for (const Variant& variant : expand_lists(object, name, name_given, *type, where)) {
    check_name(variant.name, *type, where);
    specs.push_back({variant.name, type->name, Parameters(type->parameters, variant.parameters, where), crew});
  }
  return specs;
}

}  // namespace aloft::agents
