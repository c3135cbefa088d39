#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "common/agents/load_plugin.hpp"
#include "common/agents/registry.hpp"
#include "common/agents/relay.hpp"
#include "common/base/error.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"
#include "common/flight/testing/conformance.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

using agents::AgentType;
using agents::Privilege;

nlohmann::json as_json(const AgentType& type) {
  const agents::LoadedPlugin* plugin = agents::plugin_of(type.name);
  return {{"name", type.name},
          {"description", type.description},
          {"privilege", agents::privilege_tier(type.privilege).name},
          {"unconstrained", type.unconstrained},
          {"learns", type.is_learner()},
          {"name_parameter", type.name_parameter.empty() ? nlohmann::json() : nlohmann::json(type.name_parameter)},
          {"plugin", plugin == nullptr ? nlohmann::json() : nlohmann::json(plugin->file.string())},
          {"provenance", type.provenance ? type.provenance() : nlohmann::json()},
          {"parameters", schema_properties(type.parameters)}};
}

std::string range_of(const nlohmann::json& property) {
  if (property.contains("enum")) {
    std::vector<std::string> choices;
    for (const auto& choice : property["enum"]) choices.push_back(choice.get<std::string>());
    return fmt::format("{}", fmt::join(choices, " or "));
  }
  if (property.contains("minimum"))
    return fmt::format("{} to {}", property["minimum"].dump(), property["maximum"].dump());
  return property.value("type", "") == "boolean" ? "true or false" : "a text";
}

/// Prints items, broken into lines that fit the terminal.
class Printer {
 public:
  void item(std::size_t indent, const std::string& text) const {
    fmt::print("{}", wrapped(text, width_, std::string(indent, ' '), std::string(indent + 4, ' ')));
  }

 private:
  std::size_t width_ = text_width(STDOUT_FILENO);
};

/// JSON with spaces, at which lines can be broken.
std::string with_spaces(const nlohmann::json& value) {
  std::string text;
  for (const char c : value.dump()) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

void print_parameters(const Printer& print, std::span<const ParameterSpec> table) {
  const nlohmann::json properties = schema_properties(table);
  for (const ParameterSpec& spec : table) {
    const nlohmann::json& property = properties[spec.name];
    print.item(4, fmt::format("{} ({}) [{}]: {}", spec.name, range_of(property), property["default"].dump(),
                              spec.description));
  }
}

std::string marks_of(const AgentType& type) {
  std::string marks = type.is_learner() ? "  [learns]" : "";
  if (type.privilege != Privilege::none)
    marks += fmt::format("  [privileged: sees {}]", agents::privilege_tier(type.privilege).sees);
  return marks + (type.unconstrained ? "  [unconstrained: may jump]" : "");
}

void print_text(const AgentType& type, bool brief) {
  const Printer print;
  print.item(0, type.name + marks_of(type));
  print.item(4, type.description);
  if (const agents::LoadedPlugin* plugin = agents::plugin_of(type.name))
    print.item(4, fmt::format("plugin: {}", plugin->file.string()));
  if (brief) return;
  if (!type.name_parameter.empty())
    print.item(4, fmt::format("{}-VALUE is short for {} = VALUE", type.name, type.name_parameter));
  const nlohmann::json provenance = type.provenance ? type.provenance() : nlohmann::json::object();
  for (const auto& [key, value] : provenance.items())
    print.item(4, fmt::format("{}: {}", key, value.is_string() ? value.get<std::string>() : with_spaces(value)));
  print_parameters(print, type.parameters);
  if (!type.relay) return;
  print.item(4, "Each member of \"crew\" has an \"agent\" and");
  print_parameters(print, agents::crew_parameters());
}

/// Finds an agent type by its name, or by a short form that experiments accept, e.g. constant-120.
const AgentType& type_called(const std::string& name) {
  for (const AgentType& type : agents::agent_types())
    if (type.name == name) return type;
  return agents::agent_type(agents::parse_agents(name, "").front().type);
}

struct AgentsOptions {
  std::vector<std::string> names;
  std::string format;
  bool brief = false;
  bool check = false;
};

/// Prints what the conformance kit finds; returns the exit code.
int check_agents(const std::vector<std::string>& names) {
  if (names.empty()) throw InputError("--check: name the agents to check, e.g. aloft agents --check min-height");
  std::size_t found = 0;
  for (const std::string& name : names) {
    const std::vector<std::string> problems = flight::conformance_problems(name);
    found += problems.size();
    for (const std::string& problem : problems) fmt::print("{}\n", problem);
    if (problems.empty()) fmt::print("{}: conforms\n", name);
  }
  return found == 0 ? exit_ok : exit_failure;
}

int list_agents(const AgentsOptions& options) {
  if (options.check) return check_agents(options.names);
  std::vector<const AgentType*> types;
  types.reserve(options.names.size());
  for (const std::string& name : options.names) types.push_back(&type_called(name));
  if (types.empty())
    for (const AgentType& type : agents::agent_types()) types.push_back(&type);
  nlohmann::json list = nlohmann::json::array();
  for (const AgentType* type : types) {
    if (options.format == "json")
      list.push_back(as_json(*type));
    else
      print_text(*type, options.brief);
  }
  if (options.format == "json") fmt::print("{}\n", list.dump(2));
  return 0;
}

}  // namespace

void add_agents(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("agents", "List the agents: parameters, defaults, ranges, and what they are allowed to see");
  auto options = std::make_shared<AgentsOptions>();
  command->add_option("name", options->names, "Only these agents, e.g. dqn");
  command->add_flag("--brief", options->brief, "Without parameters");
  command->add_flag(
      "--check", options->check,
      "Check the named agents instead: bounds, determinism, a fresh start in every flight, save and restore");
  add_format(*command, options->format, {"text", "json"});
  command->callback([options, &job] { job = [options] { return list_agents(*options); }; });
}

}  // namespace aloft::cli
