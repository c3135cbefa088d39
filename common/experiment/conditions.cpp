#include "common/experiment/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/radio/generated_world.hpp"

namespace aloft::experiment {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

WorldKind kind_of(const OrderedJson& world, const std::string& where) {
  const auto kind = world.find("kind");
  if (kind == world.end()) {
    if (world.contains("file"))
      throw InputError("{}: \"file\" is for measured flights; add \"kind\": \"measured\"", where);
    return WorldKind::generated;
  }
  if (*kind == "generated") return WorldKind::generated;
  if (*kind == "measured") return WorldKind::measured;
  throw InputError("{}.kind: {} is not allowed; use one of \"generated\", \"measured\"", where, excerpt(kind->dump()));
}

std::string name_of(const OrderedJson& world, const std::string& where) {
  const auto name = world.find("name");
  if (name == world.end()) return {};
  const bool is_text = name->is_string();
  std::string text = is_text ? name->get<std::string>() : "";
  if (text.empty() || text.size() > max_world_name_bytes || plain_text(text) != text)
    throw InputError("{}.name: {} is not allowed; use a text of 1 to {} bytes, printable and on one line", where,
                     excerpt(name->dump()), max_world_name_bytes);
  return text;
}

/// One parameter and all its values; `swept` if they came in a list.
struct Axis {
  std::string key;
  std::vector<Json> values;
  bool swept = false;
};

Axis axis_of(const std::string& key, const OrderedJson& value, const std::string& where) {
  if (!value.is_array()) return {key, {Json(value)}, false};
  if (value.size() > max_conditions)
    throw InputError("{}.{}: the list has {} values, but an experiment has at most {} conditions; list fewer", where,
                     excerpt(key), value.size(), max_conditions);
  Axis axis{key, {}, true};
  std::set<Json> seen;
  for (const OrderedJson& entry : value) {
    const Json one(entry);
    if (!seen.insert(one).second)
      throw InputError("{}.{}: {} stands twice in the list; keep one", where, excerpt(key), excerpt(one.dump()));
    axis.values.push_back(one);
  }
  if (axis.values.empty())
    throw InputError("{}.{}: the list is empty; give at least one value, or no list", where, excerpt(key));
  return axis;
}

std::vector<Axis> axes_of(const OrderedJson& world, const std::string& where) {
  std::vector<Axis> axes;
  for (const auto& [key, value] : world.items())
    if (key != "kind" && key != "name" && key != "swept") axes.push_back(axis_of(key, value, where));
  return axes;
}

std::string as_text(const std::string& key, const Json& value) {
  if (key == "file" || key == "sites_file") return std::filesystem::path(value.get<std::string>()).filename().string();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// The parameters that vary: those given as lists, or in a resolved experiment those named in "swept".
std::vector<std::string> swept_keys(const OrderedJson& world, const std::vector<Axis>& axes, const std::string& where) {
  std::vector<std::string> keys;
  for (const Axis& axis : axes)
    if (axis.swept) keys.push_back(axis.key);
  const auto given = world.find("swept");
  if (given == world.end()) return keys;
  const bool texts =
      given->is_array() && given->size() <= axes.size() && std::ranges::all_of(*given, [&](const OrderedJson& key) {
        return key.is_string() &&
               std::ranges::any_of(axes, [&](const Axis& axis) { return axis.key == key.get<std::string>(); });
      });
  if (!texts || !keys.empty() || !world.contains("name"))
    throw InputError(
        "{}.swept: {} is not allowed; it stands only in resolved experiments, beside \"name\", "
        "and lists keys of this world; to sweep a parameter, give it a list of values",
        where, excerpt(given->dump()));
  return given->get<std::vector<std::string>>();
}

class WorldExpansion {
 public:
  WorldExpansion(const OrderedJson& world, std::string where, const FileAccess& files)
      : where_(std::move(where)),
        files_(files),
        kind_(kind_of(world, where_)),
        name_(name_of(world, where_)),
        axes_(axes_of(world, where_)),
        swept_(swept_keys(world, axes_, where_)),
        name_is_final_(world.contains("swept")) {}

  /// Number of conditions; limit + 1 stands for all numbers above `limit`.
  [[nodiscard]] std::size_t count(std::size_t limit) const {
    std::size_t product = 1;
    for (const Axis& axis : axes_) product = std::min(product * axis.values.size(), limit + 1);
    return product;
  }

  void append_to(std::vector<Condition>& conditions) const {
    std::vector<std::size_t> at(axes_.size(), 0);
    while (true) {
      conditions.push_back(condition(at, static_cast<std::uint32_t>(conditions.size())));
      std::size_t axis = axes_.size();
      while (axis > 0 && ++at[axis - 1] == axes_[axis - 1].values.size()) at[--axis] = 0;
      if (axis == 0) return;
    }
  }

 private:
  [[nodiscard]] Condition condition(const std::vector<std::size_t>& at, std::uint32_t index) const {
    Json given = Json::object();
    for (std::size_t i = 0; i < axes_.size(); ++i) given[axes_[i].key] = axes_[i].values[at[i]];
    Condition condition{index, name_, Json::object(), kind_, {}};
    condition.world = kind_ == WorldKind::generated ? radio::resolve_generated_world(given, where_)
                                                    : resolve_measured_world(given, where_, files_);
    Json all = condition.world.to_json();
    all.insert(given.begin(), given.end());  // adds a swept default that to_json() leaves out
    for (const std::string& key : swept_) {
      condition.parameters[key] = all.at(key);
      if (!name_is_final_)
        condition.name += fmt::format("{}{}={}", condition.name.empty() ? "" : " ", key, as_text(key, all.at(key)));
    }
    if (condition.name.empty()) condition.name = kind_ == WorldKind::generated ? "generated" : "measured";
    return condition;
  }

  std::string where_;
  const FileAccess& files_;
  WorldKind kind_;
  std::string name_;
  std::vector<Axis> axes_;
  std::vector<std::string> swept_;
  bool name_is_final_;
};

/// The world objects with their JSON paths.
std::vector<std::pair<const OrderedJson*, std::string>> world_objects(const OrderedJson& document) {
  const bool one = document.contains("world");
  if (one == document.contains("worlds"))
    throw InputError(one ? "\"world\" and \"worlds\" cannot stand together; use one of them"
                         : "\"world\" is missing; give one world, or several as a list under \"worlds\"");
  std::vector<std::pair<const OrderedJson*, std::string>> objects;
  if (one) {
    objects.emplace_back(&document.at("world"), "world");
  } else {
    const OrderedJson& list = document.at("worlds");
    if (!list.is_array() || list.empty())
      throw InputError("worlds: {} is not allowed; use a list of at least one world", excerpt(list.dump()));
    for (std::size_t i = 0; i < list.size(); ++i) objects.emplace_back(&list[i], fmt::format("worlds[{}]", i));
  }
  for (const auto& [world, where] : objects)
    if (!world->is_object())
      throw InputError("{}: {} is not allowed; use an object of parameters", where, excerpt(world->dump()));
  return objects;
}

void check_names(const std::vector<Condition>& conditions) {
  std::map<std::string_view, std::uint32_t> seen;
  for (const Condition& condition : conditions) {
    const auto [other, is_new] = seen.emplace(condition.name, condition.index);
    if (!is_new)
      throw InputError("conditions {} and {} are both named \"{}\"; give their worlds different \"name\"s",
                       other->second, condition.index, condition.name);
  }
}

}  // namespace

std::vector<Condition> expand_worlds(const OrderedJson& document, const FileAccess& files) {
  std::vector<Condition> conditions;
  for (const auto& [world, where] : world_objects(document)) {
    const WorldExpansion expansion(*world, where, files);
    if (conditions.size() + expansion.count(max_conditions) > max_conditions)
      throw InputError("{}: the sweep has more than {} conditions; list fewer values, or make several experiments",
                       where, max_conditions);
    expansion.append_to(conditions);
  }
  check_names(conditions);
  return conditions;
}

Json canonical_world(const Condition& condition) {
  Json world = condition.world.to_json();
  world["kind"] = condition.kind == WorldKind::generated ? "generated" : "measured";
  world["name"] = condition.name;
  Json swept = Json::array();
  for (const auto& [key, value] : condition.parameters.items()) {
    swept.push_back(key);
    world[key] = value;
  }
  world["swept"] = std::move(swept);
  return world;
}

}  // namespace aloft::experiment
