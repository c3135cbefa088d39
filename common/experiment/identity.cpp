#include "common/experiment/identity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/base/digest.hpp"
#include "common/experiment/file_keys.hpp"

namespace aloft::experiment {
namespace {

using Json = nlohmann::json;

/// Settings added when results were already stored: at their defaults they do not enter the id.
constexpr std::array later_settings{"speed_m_per_s", "energy_weight", "handover_cost", "handover_loss",
                                    "outage_threshold_db"};

/// Removes the file paths of an agent and of a relay's crew, and a foreign agent's privilege if it is "none": older
/// experiments do not have that key.
void forget_file(Json& agent) {
  const agents::AgentType& type = agents::agent_type(agent.at("type").get<std::string>());
  if (const std::string& file = type.file_parameter; !file.empty()) {
    agent.erase(file);
    if (agent.value(file + "_sha256", "").empty()) agent.erase(file + "_sha256");
  }
  if (type.foreign && agent.value("privilege", "none") == "none") agent.erase("privilege");
  if (const auto crew = agent.find("crew"); crew != agent.end())
    for (Json& member : *crew) forget_file(member.at("agent"));
}

Json identity(const Json& canonical) {
  Json rest = what_counts(canonical);
  for (const ParameterSpec& setting : file_settings())
    if (std::ranges::find(later_settings, setting.name) != later_settings.end() &&
        rest.value(setting.name, 0.0) == std::get<double>(setting.default_value))
      rest.erase(setting.name);
  return rest;
}

constexpr std::size_t differences_shown = 3;
constexpr std::size_t names_shown = 12;
constexpr std::size_t value_length = 80;

std::string shortened(const Json& value) {
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > value_length) text = text.substr(0, value_length) + "...";
  return text;
}

std::vector<std::string> names_of(const Json& agents) {
  std::vector<std::string> names;
  for (const Json& agent : agents) names.push_back(agent.at("name").get<std::string>());
  return names;
}

std::string listed(std::vector<std::string> names) {
  const std::size_t more = names.size() - std::min(names.size(), names_shown);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// Every place at which two experiments differ, in words.
class Differences {
 public:
  Differences(const Json& there, const Json& here) {
    if (const auto agents = std::pair(names_of(there.at("agents")), names_of(here.at("agents")));
        agents.first != agents.second)
      found_.push_back(fmt::format("the agents are {} there and {} here", listed(agents.first), listed(agents.second)));
    Json a = there;
    Json b = here;
    if (!found_.empty())
      for (Json* one : {&a, &b}) one->erase("agents");
    compare(a, b, "");
  }

  [[nodiscard]] std::string sentence() const {
    const std::size_t shown = std::min(found_.size(), differences_shown);
    return fmt::format("{}{}", fmt::join(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(shown), "; "),
                       found_.size() > shown ? fmt::format("; and {} more", found_.size() - shown) : "");
  }

 private:
  void compare(const Json& a, const Json& b, const std::string& path) {
    if (a == b) return;
    if (a.is_object() && b.is_object()) return compare_objects(a, b, path);
    if (a.is_array() && b.is_array() && a.size() == b.size()) {
      for (std::size_t i = 0; i < a.size(); ++i) compare(a[i], b[i], fmt::format("{}[{}]", path, i));
    } else if (path == "worlds") {
      found_.push_back(fmt::format("there are {} conditions there and {} here", a.size(), b.size()));
    } else {
      found_.push_back(fmt::format("{} is {} there and {} here", path, shortened(a), shortened(b)));
    }
  }

  void compare_objects(const Json& a, const Json& b, const std::string& path) {
    Json keys = a;
    keys.update(b);
    for (const auto& item : keys.items()) {
      const std::string inside = path.empty() ? item.key() : fmt::format("{}.{}", path, item.key());
      const bool in_a = a.contains(item.key());
      if (in_a && b.contains(item.key()))
        compare(a.at(item.key()), b.at(item.key()), inside);
      else
        found_.push_back(fmt::format("{} is {} {} and not set {}", inside, shortened(item.value()),
                                     in_a ? "there" : "here", in_a ? "here" : "there"));
    }
  }

  std::vector<std::string> found_;
};

}  // namespace

Json what_counts(const Json& canonical) {
  Json rest = canonical;
  rest.erase("description");
  for (Json& world : rest.at("worlds"))
    for (const char* key : {"file", "sites_file", "name", "swept"}) world.erase(key);
  for (Json& agent : rest.at("agents")) forget_file(agent);
  return rest;
}

std::string id_of(const Json& canonical) {
  return sha256_hex(identity(canonical).dump()).substr(0, 16);
}

std::string describe_differences(const Json& there, const Json& here) {
  return Differences(identity(there), identity(here)).sentence();
}

}  // namespace aloft::experiment
