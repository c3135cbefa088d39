#include "common/experiment/identity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "common/agents/registry.hpp"
#include "common/base/digest.hpp"
#include "common/experiment/file_keys.hpp"

namespace aloft::experiment {
namespace {

using Json = nlohmann::json;

/// Settings that came after the first results were stored: at their defaults they change nothing.
constexpr std::array later_settings{"speed_m_per_s", "energy_weight", "handover_cost"};

/// What cannot change a result is left out: a file counts by its SHA-256.
Json identity(const Json& canonical) {
  Json rest = canonical;
  rest.erase("description");
  for (const ParameterSpec& setting : file_settings())
    if (std::find(later_settings.begin(), later_settings.end(), setting.name) != later_settings.end() &&
        rest.value(setting.name, 0.0) == std::get<double>(setting.default_value))
      rest.erase(setting.name);
  for (Json& world : rest.at("worlds"))
    for (const char* key : {"file", "name", "swept"}) world.erase(key);
  for (Json& agent : rest.at("agents"))
    if (const std::string& file = agents::agent_type(agent.at("type").get<std::string>()).file_parameter;
        !file.empty()) {
      agent.erase(file);
      if (agent.value(file + "_sha256", "").empty()) agent.erase(file + "_sha256");
    }
  return rest;
}

std::string difference(const Json& a, const Json& b, const std::string& path) {
  if (a == b) return {};
  if (a.is_object() && b.is_object()) {
    Json keys = a;
    keys.update(b);
    for (const auto& item : keys.items()) {
      const std::string inside = path.empty() ? item.key() : fmt::format("{}.{}", path, item.key());
      const bool both = a.contains(item.key()) && b.contains(item.key());
      if (!both) return fmt::format("{}: only in {}", inside, a.contains(item.key()) ? "the first" : "the second");
      if (std::string found = difference(a.at(item.key()), b.at(item.key()), inside); !found.empty()) return found;
    }
  }
  if (a.is_array() && b.is_array()) {
    if (a.size() != b.size()) return fmt::format("{}: {} entries against {}", path, a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::string found = difference(a[i], b[i], fmt::format("{}[{}]", path, i)); !found.empty()) return found;
  }
  return fmt::format("{}: {} against {}", path, a.dump(), b.dump());
}

}  // namespace

std::string id_of(const Json& canonical) {
  return sha256_hex(identity(canonical).dump()).substr(0, 16);
}

std::string describe_difference(const Json& a, const Json& b) {
  return difference(identity(a), identity(b), "");
}

}  // namespace aloft::experiment
