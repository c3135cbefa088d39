#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace aloft {

/// One adjustable fact of a world or an agent, as data: help texts, schema, documentation and range checks all come
/// from tables of these.
struct ParameterSpec {
  enum class Kind { number, integer, flag, choice, text };

  std::string name;  ///< with its unit, e.g. "height_m"
  Kind kind = Kind::number;
  std::string description;  ///< one sentence
  std::variant<bool, double, std::string> default_value =
      0.0;               ///< bool: flag; double: number, integer; string: choice, text
  double minimum = 0.0;  ///< number, integer: inclusive range
  double maximum = 0.0;
  std::vector<std::string> choices;  ///< choice: the allowed values
};

/// Makers for tables.
[[nodiscard]] ParameterSpec number_parameter(std::string name, double default_value, double minimum, double maximum,
                                             std::string description);
[[nodiscard]] ParameterSpec integer_parameter(std::string name, double default_value, double minimum, double maximum,
                                              std::string description);
[[nodiscard]] ParameterSpec flag_parameter(std::string name, bool default_value, std::string description);
[[nodiscard]] ParameterSpec choice_parameter(std::string name, std::string default_value,
                                             std::vector<std::string> choices, std::string description);
[[nodiscard]] ParameterSpec text_parameter(std::string name, std::string default_value, std::string description);

/// Values for every entry of a table, checked: defaults filled in, in the table's order.
class Parameters {
 public:
  Parameters() = default;
  /// The defaults of the table.
  explicit Parameters(std::span<const ParameterSpec> table);
  /// `given` is a JSON object of overrides. Throws InputError naming `where` (a JSON path such as "world" or
  /// "agents[2]"), the key, the allowed values and, for an unknown key, the nearest valid one. NaN and infinity are
  /// refused.
  Parameters(std::span<const ParameterSpec> table, const nlohmann::json& given, std::string_view where);

  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] int integer(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::string_view name) const;  ///< a choice or a text

  /// All values, defaults included, keys sorted: the canonical form that ids are made of. Whole numbers are written as
  /// integers.
  [[nodiscard]] nlohmann::json to_json() const;

 private:
  using Value = std::variant<bool, double, std::string>;
  [[nodiscard]] const Value& value(std::string_view name) const;
  std::vector<std::pair<std::string, Value>> values_;
};

/// The table as JSON Schema "properties" (type, default, minimum, maximum, enum, description).
[[nodiscard]] nlohmann::json schema_properties(std::span<const ParameterSpec> table);

}  // namespace aloft
