#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/agents/relay.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

using agents::AgentType;
using agents::Privilege;

nlohmann::json as_json(const AgentType& type) {
  return {{"name", type.name},
          {"description", type.description},
          {"privilege", agents::privilege_tier(type.privilege).name},
          {"unconstrained", type.unconstrained},
          {"learns", type.learns},
          {"name_parameter", type.name_parameter.empty() ? nlohmann::json() : nlohmann::json(type.name_parameter)},
          {"provenance", type.provenance ? type.provenance() : nlohmann::json()},
          {"parameters", schema_properties(type.parameters)}};
}

std::string range_of(const nlohmann::json& property) {
  if (property.contains("enum")) {
    std::string text;
    for (const auto& choice : property["enum"]) text += (text.empty() ? "" : " | ") + choice.get<std::string>();
    return text;
  }
  if (property.contains("minimum"))
    return fmt::format("{} .. {}", property["minimum"].dump(), property["maximum"].dump());
  return property.value("type", "");
}

void print_table(std::span<const ParameterSpec> table) {
  const nlohmann::json properties = schema_properties(table);
  for (const ParameterSpec& spec : table) {
    const nlohmann::json& property = properties[spec.name];
    fmt::print("    {:<26} {:<14} {:<24} {}\n", spec.name, property["default"].dump(), range_of(property),
               spec.description);
  }
}

void print_text(const AgentType& type) {
  std::string marks = type.learns ? "  [learns]" : "";
  if (type.privilege != Privilege::none)
    marks += fmt::format("  [privileged: sees {}]", agents::privilege_tier(type.privilege).sees);
  if (type.unconstrained) marks += "  [unconstrained: may jump]";
  fmt::print("{}{}\n    {}\n", type.name, marks, type.description);
  if (!type.name_parameter.empty())
    fmt::print("    {}-VALUE is short for {} = VALUE\n", type.name, type.name_parameter);
  const nlohmann::json provenance = type.provenance ? type.provenance() : nlohmann::json::object();
  for (const auto& [key, value] : provenance.items())
    fmt::print("    {}: {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  print_table(type.parameters);
  if (!type.relay) return;
  fmt::print("    Each member of \"crew\" has an \"agent\" and\n");
  print_table(agents::crew_parameters());
}

}  // namespace

void add_agents(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("agents", "List the agents: parameters, defaults, ranges, and what they are allowed to see");
  auto format = std::make_shared<std::string>();
  add_format(*command, *format, {"text", "json"});
  command->callback([format, &job] {
    job = [format] {
      nlohmann::json list = nlohmann::json::array();
      for (const AgentType& type : agents::agent_types()) {
        if (*format == "json")
          list.push_back(as_json(type));
        else
          print_text(type);
      }
      if (*format == "json") fmt::print("{}\n", list.dump(2));
      return 0;
    };
  });
}

}  // namespace aloft::cli
