#include "tools/reference/pages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/agents/relay.hpp"
#include "common/experiment/file_keys.hpp"
#include "common/experiment/schema.hpp"
#include "common/experiment/world_parameters.hpp"
#include "common/radio/generated_world.hpp"
#include "common/store/database.hpp"
#include "tools/reference/markdown_table.hpp"

namespace aloft::reference {
namespace {

using Json = nlohmann::json;

/// The keys of an experiment file that are no plain parameters.
std::string structure_table() {
  const Json properties = experiment::experiment_schema().at("properties");
  const auto settings = experiment::file_settings();
  std::string text = "| key | meaning |\n|---|---|\n";
  for (const auto& [key, property] : properties.items()) {
    const auto is_it = [&key = key](const ParameterSpec& spec) { return spec.name == key; };
    if (std::ranges::none_of(settings, is_it))
      text += fmt::format("| `{}` | {} |\n", key, cell(property.at("description").get<std::string>()));
  }
  return text;
}

/// The parameters in which the presets differ, with their values in each.
std::string preset_table() {
  const std::vector<ParameterSpec>& table = radio::generated_world_parameters();
  const std::vector<std::string>& presets = table.front().choices;
  std::vector<Json> worlds;
  worlds.reserve(presets.size());
  for (const std::string& preset : presets)
    worlds.push_back(radio::resolve_generated_world({{"preset", preset}}, "world").to_json());
  std::string text = fmt::format("| key | `{}` |\n|---|", fmt::join(presets, "` | `"));
  for (std::size_t i = 0; i < presets.size(); ++i) text += "---|";
  text += "\n";
  for (const ParameterSpec& spec : table) {
    std::vector<std::string> cells;
    bool same = true;
    for (const Json& world : worlds) {
      const Json value = world.value(spec.name, Json());
      same = same && value == worlds.front().value(spec.name, Json());
      cells.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    }
    if (!same && spec.name != "preset") text += fmt::format("| `{}` | {} |\n", spec.name, fmt::join(cells, " | "));
  }
  return text;
}

std::string experiments_page() {
  const auto required = experiment::experiment_schema().at("required").get<std::vector<std::string>>();
  return fmt::format(
      "# Keys of an experiment file\n{}\n"
      "[data/README.md](../../data/README.md) tells how an experiment is written; `aloft validate` shows what one "
      "comes to.\n\n"
      "## The file\n{}\n{}\n"
      "## A generated world\nEvery key takes a value, or a list of values to sweep.\n\n{}\n"
      "### Presets\n\n{}\n"
      "## A measured world\n\n{}\n"
      "## Agents\nAn entry is the name of an agent, or an object: its `type`, optionally a `name` of its own, and "
      "parameters: [agents.md](agents.md).\n",
      made_by, structure_table(), parameter_table(experiment::file_settings(), required),
      parameter_table(radio::generated_world_parameters()), preset_table(),
      parameter_table(experiment::measured_world_parameters()));
}

std::string marks_of(const agents::AgentType& type) {
  std::string text;
  if (type.privilege != agents::Privilege::none)
    text += fmt::format(" Privileged: sees {}.", agents::privilege_tier(type.privilege).sees);
  if (type.unconstrained) text += " Unconstrained: may jump to any height.";
  if (type.is_learner()) text += " Learns.";
  if (type.trained_beforehand) text += " Trained beforehand.";
  if (!type.name_parameter.empty())
    text += fmt::format(" `{}-VALUE` is short for `{}` = VALUE.", type.name, type.name_parameter);
  return text;
}

std::string agents_page() {
  std::string text = fmt::format(
      "# Agents and their parameters\n{}\n"
      "`aloft agents` prints the same. Every parameter takes a value, or a list of values: one agent for each.\n",
      made_by);
  for (const agents::AgentType& type : agents::agent_types()) {
    text += fmt::format("\n## {}\n{}{}\n", type.name, type.description, marks_of(type));
    if (!type.parameters.empty()) text += "\n" + parameter_table(type.parameters);
    if (type.relay)
      text += "\nEach member of its `crew` has an `agent` and\n\n" + parameter_table(agents::crew_parameters());
  }
  return text;
}

}  // namespace

std::vector<Page> pages() {
  return {{"experiments.md", experiments_page()},
          {"agents.md", agents_page()},
          {"database.md", database_page(store::database_schema(), store::database_version())}};
}

}  // namespace aloft::reference
