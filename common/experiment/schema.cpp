#include "common/experiment/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/agents/relay.hpp"
#include "common/base/limits.hpp"
#include "common/experiment/conditions.hpp"
#include "common/experiment/file_keys.hpp"
#include "common/experiment/world_parameters.hpp"
#include "common/flight/energy.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/radio/serving_rule.hpp"

namespace aloft::experiment {
namespace {

using Json = nlohmann::json;

/// A value, or a list of values to sweep.
Json value_or_list(Json value) {
  Json description = value.at("description");
  Json default_value = value.at("default");
  value.erase("description");
  value.erase("default");
  Json list{{"type", "array"}, {"minItems", 1}, {"uniqueItems", true}, {"items", value}};
  return {{"description", std::move(description)},
          {"default", std::move(default_value)},
          {"anyOf", Json::array({std::move(value), std::move(list)})}};
}

Json sweepable(std::span<const ParameterSpec> table) {
  Json properties = schema_properties(table);
  for (Json& property : properties) property = value_or_list(std::move(property));
  return properties;
}

Json world_schema(const char* kind, std::span<const ParameterSpec> table) {
  Json properties = sweepable(table);
  properties["kind"] = {{"const", kind}};
  properties["name"] = {{"type", "string"},
                        {"minLength", 1},
                        {"maxLength", max_world_name_bytes},
                        {"description", "Name of the condition; the swept values are appended to it."}};
  properties["swept"] = {{"type", "array"},
                         {"items", {{"type", "string"}}},
                         {"description", "Only in resolved experiments: which parameters were swept."}};
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

/// A value of this key that is one of `words`, or a list of such.
Json one_of_these(const char* key, const std::vector<std::string>& words) {
  const Json one{{"enum", words}};
  return {{"properties", {{key, {{"anyOf", Json::array({one, Json{{"type", "array"}, {"items", one}}})}}}}}};
}

/// The parameters of channel models, by the models that have them.
std::map<std::vector<std::string>, std::vector<std::string>> parameters_by_models() {
  std::map<std::string, std::vector<std::string>> models_of;
  for (const radio::LinkModelType& model : radio::link_model_types())
    for (const ParameterSpec& spec : model.parameters) models_of[spec.name].push_back(model.name);
  std::map<std::vector<std::string>, std::vector<std::string>> parameters;
  for (const auto& [parameter, models] : models_of) parameters[models].push_back(parameter);
  return parameters;
}

/// A world has the parameters of its own channel model alone: of the one it names, or that of its preset.
Json channel_model_rules() {
  Json rules = Json::array();
  for (const auto& [models, parameters] : parameters_by_models()) {
    Json named = one_of_these("propagation", models);
    named["required"] = Json::array({"propagation"});
    std::vector<std::string> presets;
    for (const std::string& model : models)
      for (std::string& preset : radio::presets_with(radio::link_model_type(model)))
        presets.push_back(std::move(preset));
    Json of_preset = one_of_these("preset", presets);
    of_preset["not"] = {{"required", Json::array({"propagation"})}};
    if (std::ranges::find(models, radio::default_link_model) == models.end())
      of_preset["required"] = Json::array({"preset"});
    Json chosen{{"anyOf", Json::array({std::move(named)})}};
    if (!presets.empty()) chosen["anyOf"].push_back(std::move(of_preset));
    Json own = Json::object();
    for (const std::string& parameter : parameters) own[parameter] = false;
    rules.push_back({{"if", std::move(chosen)}, {"else", {{"properties", std::move(own)}}}});
  }
  return rules;
}

/// Only worlds with handovers have their parameters.
Json handover_rule() {
  Json chosen = one_of_these("serving", {"a3"});
  chosen["required"] = Json::array({"serving"});
  Json own = Json::object();
  for (const ParameterSpec& spec : radio::a3_parameters()) own[spec.name] = false;
  return {{"if", std::move(chosen)}, {"else", {{"properties", std::move(own)}}}};
}

Json any_world() {
  Json measured = world_schema("measured", measured_world_parameters());
  measured["required"] = Json::array({"kind", "file"});
  Json generated = world_schema("generated", radio::generated_world_parameters());
  generated["allOf"] = channel_model_rules();
  generated["allOf"].push_back(handover_rule());
  return {{"type", "object"},
          {"description", "One world; every list in it is swept. A file has either \"world\" or \"worlds\"."},
          {"if", {{"properties", {{"kind", {{"const", "measured"}}}}}, {"required", Json::array({"kind"})}}},
          {"then", std::move(measured)},
          {"else", std::move(generated)}};
}

Json any_crew() {
  Json properties = schema_properties(agents::crew_parameters());
  properties["agent"] = {{"$ref", "#/properties/agents/items"}};
  return {{"type", "array"},
          {"minItems", 2},
          {"maxItems", agents::max_crew},
          {"description", "The agents that share each flight; the first flies from step 1."},
          {"items",
           {{"type", "object"},
            {"required", Json::array({"agent"})},
            {"properties", std::move(properties)},
            {"additionalProperties", false}}}};
}

Json any_agent() {
  const Json name{{"type", "string"}, {"pattern", "^[a-z0-9.-]{1,64}$"}};
  Json rules = Json::array();
  for (const agents::AgentType& type : agents::agent_types()) {
    Json properties = sweepable(type.parameters);
    properties["type"] = true;
    properties["name"] = true;
    if (type.relay) properties["crew"] = any_crew();
    Json rule{
        {"description", type.description}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    if (type.relay) rule["required"] = Json::array({"name", "crew"});
    if (type.foreign) rule["required"] = Json::array({"name"});
    rules.push_back({{"if", {{"properties", {{"type", {{"const", type.name}}}}}, {"required", Json::array({"type"})}}},
                     {"then", std::move(rule)}});
  }
  Json object{{"type", "object"},
              {"required", Json::array({"type"})},
              {"properties", {{"type", name}, {"name", name}}},
              {"allOf", std::move(rules)}};
  return {{"anyOf", Json::array({name, std::move(object)})}};
}

}  // namespace

Json experiment_schema() {
  Json properties = schema_properties(file_settings());
  properties["name"]["pattern"] = fmt::format("^[A-Za-z0-9_-][A-Za-z0-9._-]{{0,{}}}$", limits::name_bytes - 1);
  for (const char* required : {"name", "trials"}) properties[required].erase("default");
  properties["$schema"] = {{"type", "string"}, {"description", "Path or address of this schema, for editors."}};
  properties["build"] = {{"type", "string"}, {"description", "Written into resolved experiments; ignored when read."}};
  properties["seed"] = {{"type", "integer"},
                        {"minimum", 0},
                        {"exclusiveMaximum", 0x1p64},
                        {"default", default_seed},
                        {"description", "Seed of all randomness; below 2^64."}};
  properties["world"] = any_world();
  properties["worlds"] = {{"type", "array"},
                          {"minItems", 1},
                          {"description", "Several worlds, each with its own sweep; instead of \"world\"."},
                          {"items", {{"$ref", "#/properties/world"}}}};
  properties["agents"] = {{"type", "array"},
                          {"minItems", 1},
                          {"maxItems", limits::agents},
                          {"description", "The agents that fly, all in the same worlds."},
                          {"items", any_agent()}};
  return {{"$schema", "http://json-schema.org/draft-07/schema#"},
          {"title", "Aloft experiment"},
          {"type", "object"},
          {"properties", std::move(properties)},
          {"required", Json::array({"name", "trials", "agents"})},
          {"oneOf", Json::array({{{"required", Json::array({"world"})}}, {{"required", Json::array({"worlds"})}}})},
          {"additionalProperties", false}};
}

std::span<const ParameterSpec> file_settings() {
  static const std::vector<ParameterSpec> table{
      text_parameter("name", "",
                     "Name of the experiment: letters, digits, '-', '_', '.'; result folders are named after it."),
      text_parameter("description", "", "For readers; changes no result."),
      integer_parameter("trials", 1, 1, 10'000'000, "Worlds per condition; every agent flies in each."),
      choice_parameter("on_agent_loss", "restart", {"restart", "failover"},
                       "When an agent is lost: fly again from the start, or let the next agent take over."),
      integer_parameter("max_attempts", 3, 1, 100, "How many times a failing trial is tried."),
      number_parameter(
          "speed_m_per_s", flight::Costs{}.speed_m_per_s, 1, 40,
          "Speed of the UAV along its route, for its energy, outage and handovers; a step of a measured flight "
          "counts as 10 m."),
      number_parameter("energy_weight", 0, 0, 1e4, "Subtracted from the reward per joule, in bit/s/Hz or kbit/s."),
      number_parameter("handover_cost", 0, 0, 1e6,
                       "Subtracted from the reward per change of serving cell, in bit/s/Hz or kbit/s."),
      number_parameter("handover_loss", flight::Costs{}.handover_loss, 0, 1,
                       "Factor of the quality in the reward of a step with a change of serving cell; 1: no loss."),
      number_parameter("outage_threshold_db", flight::Costs{}.outage_threshold_db, -30, 30,
                       "Time with a lower SINR of the serving cell counts as outage."),
  };
  return table;
}

std::vector<std::string> file_keys() {
  std::vector<std::string> keys;
  const Json schema = experiment_schema();
  for (const auto& item : schema.at("properties").items()) keys.push_back(item.key());
  return keys;
}

}  // namespace aloft::experiment
