#include "common/base/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"

namespace aloft {
namespace {

using Json = nlohmann::json;
using Kind = ParameterSpec::Kind;
using Value = std::variant<bool, double, std::string>;

std::string path_of(std::string_view where, std::string_view key) {
  return where.empty() ? std::string(key) : fmt::format("{}.{}", where, key);
}

std::string allowed(const ParameterSpec& spec) {
  switch (spec.kind) {
    case Kind::number:
      return fmt::format("a number from {} to {}", spec.minimum, spec.maximum);
    case Kind::integer:
      return fmt::format("a whole number from {} to {}", spec.minimum, spec.maximum);
    case Kind::flag:
      return "true or false";
    case Kind::choice:
      return fmt::format("one of \"{}\"", fmt::join(spec.choices, "\", \""));
    case Kind::text:
      return "a text";
  }
  return {};
}

bool fits(const ParameterSpec& spec, const Json& given) {
  switch (spec.kind) {
    case Kind::number:
    case Kind::integer: {
      if (!given.is_number()) return false;
      const auto x = given.get<double>();
      return std::isfinite(x) && x >= spec.minimum && x <= spec.maximum &&
             (spec.kind == Kind::number || x == std::floor(x));
    }
    case Kind::flag:
      return given.is_boolean();
    case Kind::choice:
      return given.is_string() && std::ranges::find(spec.choices, given.get<std::string>()) != spec.choices.end();
    case Kind::text:
      return given.is_string();
  }
  return false;
}

Value checked(const ParameterSpec& spec, const Json& given, std::string_view where) {
  if (!fits(spec, given))
    throw InputError("{}: {} is not allowed; use {}", path_of(where, spec.name), excerpt(given.dump()), allowed(spec));
  if (given.is_boolean()) return given.get<bool>();
  if (given.is_number()) return given.get<double>();
  return given.get<std::string>();
}

Json as_json(const Value& value) {
  if (const auto* x = std::get_if<double>(&value)) {
    const auto whole = static_cast<std::int64_t>(*x);
    return std::fabs(*x) < 0x1p53 && *x == static_cast<double>(whole) ? Json(whole) : Json(*x);
  }
  return std::visit([](const auto& v) { return Json(v); }, value);
}

}  // namespace

ParameterSpec number_parameter(std::string name, double default_value, double minimum, double maximum,
                               std::string description) {
  return {std::move(name), Kind::number, std::move(description), default_value, minimum, maximum, {}};
}

ParameterSpec integer_parameter(std::string name, double default_value, double minimum, double maximum,
                                std::string description) {
  return {std::move(name), Kind::integer, std::move(description), default_value, minimum, maximum, {}};
}

ParameterSpec flag_parameter(std::string name, bool default_value, std::string description) {
  return {std::move(name), Kind::flag, std::move(description), default_value, 0, 0, {}};
}

ParameterSpec choice_parameter(std::string name, std::string default_value, std::vector<std::string> choices,
                               std::string description) {
  return {std::move(name), Kind::choice, std::move(description), std::move(default_value), 0, 0, std::move(choices)};
}

ParameterSpec text_parameter(std::string name, std::string default_value, std::string description) {
  return {std::move(name), Kind::text, std::move(description), std::move(default_value), 0, 0, {}};
}

Parameters::Parameters(std::span<const ParameterSpec> table) {
  for (const ParameterSpec& spec : table) entries_.push_back({spec.name, spec.default_value, spec.default_is_implied});
}

Parameters::Parameters(std::span<const ParameterSpec> table, const Json& given, std::string_view where)
    : Parameters(table) {
  if (!given.is_object())
    throw InputError("{}: {} is not allowed; use an object of parameters", where, excerpt(given.dump()));
  for (const auto& [key, json] : given.items()) {
    std::size_t i = 0;
    while (i < table.size() && table[i].name != key) ++i;
    if (i == table.size()) {
      std::vector<std::string> names;
      for (const ParameterSpec& spec : table) names.push_back(spec.name);
      throw InputError("{}: unknown key.{} Valid keys: {}", path_of(where, excerpt(key)), did_you_mean(key, names),
                       names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
    }
    Entry& entry = entries_[i];
    entry.value = checked(table[i], json, where);
    entry.implied = table[i].default_is_implied && entry.value == table[i].default_value;
  }
}

const Value& Parameters::value(std::string_view name) const {
  for (const Entry& entry : entries_)
    if (entry.name == name) return entry.value;
  throw std::logic_error(fmt::format("no parameter '{}' in this table", name));
}

double Parameters::number(std::string_view name) const {
  return std::get<double>(value(name));
}
int Parameters::integer(std::string_view name) const {
  return static_cast<int>(number(name));
}
bool Parameters::flag(std::string_view name) const {
  return std::get<bool>(value(name));
}
const std::string& Parameters::text(std::string_view name) const {
  return std::get<std::string>(value(name));
}

void Parameters::refuse_choice(std::string_view name) const {
  throw std::logic_error(fmt::format("parameter '{}' has the unknown value '{}'", name, text(name)));
}

Json Parameters::to_json() const {
  Json object = Json::object();
  for (const Entry& entry : entries_)
    if (!entry.implied) object[entry.name] = as_json(entry.value);
  return object;
}

Json schema_properties(std::span<const ParameterSpec> table) {
  Json properties = Json::object();
  for (const ParameterSpec& spec : table) {
    Json property{{"description", spec.description}, {"default", as_json(spec.default_value)}};
    switch (spec.kind) {
      case Kind::number:
      case Kind::integer:
        property["type"] = spec.kind == Kind::integer ? "integer" : "number";
        property["minimum"] = as_json(spec.minimum);
        property["maximum"] = as_json(spec.maximum);
        break;
      case Kind::flag:
        property["type"] = "boolean";
        break;
      case Kind::choice:
        property["enum"] = spec.choices;
        break;
      case Kind::text:
        property["type"] = "string";
        break;
    }
    properties[spec.name] = property;
  }
  return properties;
}

}  // namespace aloft
