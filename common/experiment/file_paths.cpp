#include "common/experiment/file_paths.hpp"

#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::experiment {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The value of a parameter, or every value of a sweep over it.
void anchor_value(OrderedJson& object, const std::string& key, const std::filesystem::path& folder) {
  const auto anchor = [&](OrderedJson& value) {
    if (!value.is_string()) return;
    const std::filesystem::path path = value.get<std::string>();
    if (!path.empty() && path.is_relative()) value = (folder / path).lexically_normal().string();
  };
  const auto found = object.find(key);
  if (found == object.end()) return;
  if (!found->is_array()) return anchor(*found);
  for (OrderedJson& value : *found) anchor(value);
}

void anchor_world(OrderedJson& world, const std::filesystem::path& folder) {
  if (!world.is_object()) return;
  for (const char* key : {"file", "sites_file"}) anchor_value(world, key, folder);
}

void anchor_agent(OrderedJson& agent, const std::filesystem::path& folder) {
  if (!agent.is_object()) return;
  for (const agents::AgentType& type : agents::agent_types())
    if (!type.file_parameter.empty() && agent.value("type", OrderedJson()) == type.name)
      anchor_value(agent, type.file_parameter, folder);
  const auto crew = agent.find("crew");
  if (crew == agent.end() || !crew->is_array()) return;
  for (OrderedJson& member : *crew)
    if (member.is_object() && member.contains("agent")) anchor_agent(member.at("agent"), folder);
}

}  // namespace

void anchor_paths(OrderedJson& document, const std::filesystem::path& folder) {
  if (!document.is_object()) return;
  if (document.contains("world")) anchor_world(document.at("world"), folder);
  const auto anchor_list = [&](const char* list, auto anchor) {
    if (document.contains(list) && document.at(list).is_array())
      for (OrderedJson& entry : document.at(list)) anchor(entry, folder);
  };
  anchor_list("worlds", anchor_world);
  anchor_list("agents", anchor_agent);
}

std::filesystem::path locate(const std::filesystem::path& given) {
  std::filesystem::path file = std::filesystem::absolute(given).lexically_normal();
  if (std::error_code ignored; !std::filesystem::exists(file, ignored))
    throw InputError(
        "cannot read '{}': No such file or directory. Relative paths in an experiment file count from that file's "
        "folder, those on the command line from the working directory",
        excerpt(file.string()));
  return file;
}

}  // namespace aloft::experiment
