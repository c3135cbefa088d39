#include "tools/reference/markdown_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aloft::reference {
namespace {

using Kind = ParameterSpec::Kind;

std::string allowed(const ParameterSpec& spec) {
  switch (spec.kind) {
    case Kind::number:
      return fmt::format("{} to {}", spec.minimum, spec.maximum);
    case Kind::integer:
      return fmt::format("whole, {} to {}", spec.minimum, spec.maximum);
    case Kind::flag:
      return "`true`, `false`";
    case Kind::choice:
      return fmt::format("`{}`", fmt::join(spec.choices, "`, `"));
    case Kind::text:
      return "text";
  }
  return {};
}

std::string default_of(const ParameterSpec& spec, const nlohmann::json& properties) {
  const nlohmann::json& value = properties.at(spec.name).at("default");
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  return text.empty() ? "-" : fmt::format("`{}`", text);
}

}  // namespace

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, 1, '\\');
  return text;
}

std::string parameter_table(std::span<const ParameterSpec> table, std::span<const std::string> required) {
  const nlohmann::json properties = schema_properties(table);
  std::string text = "| key | default | allowed | meaning |\n|---|---|---|---|\n";
  for (const ParameterSpec& spec : table) {
    const bool must_be_given = std::ranges::find(required, spec.name) != required.end();
    text +=
        fmt::format("| `{}` | {} | {} | {} |\n", spec.name, must_be_given ? "required" : default_of(spec, properties),
                    cell(allowed(spec)), cell(spec.description));
  }
  return text;
}

}  // namespace aloft::reference
