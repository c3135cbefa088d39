#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace aloft {

/// One setting of a world or an agent, as data: help texts, JSON Schema, documentation and range checks are all made
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
  /// The canonical form leaves this parameter out while it has its default, so that experiments from before the
  /// parameter existed keep their ids.
  bool default_is_implied = false;
};

/// A word that a choice parameter allows, and its meaning in the program.
template <typename Meaning>
struct Choice {
  std::string_view word;
  Meaning meaning;
};

/// These make the entries of a table.
[[nodiscard]] ParameterSpec number_parameter(std::string name, double default_value, double minimum, double maximum,
                                             std::string description);
[[nodiscard]] ParameterSpec integer_parameter(std::string name, double default_value, double minimum, double maximum,
                                              std::string description);
[[nodiscard]] ParameterSpec flag_parameter(std::string name, bool default_value, std::string description);
[[nodiscard]] ParameterSpec choice_parameter(std::string name, std::string default_value,
                                             std::vector<std::string> choices, std::string description);
/// The first choice is the default.
template <typename Meaning, std::size_t n>
[[nodiscard]] ParameterSpec choice_parameter(std::string name, const std::array<Choice<Meaning>, n>& choices,
                                             std::string description) {
  std::vector<std::string> words;
  words.reserve(n);
  for (const auto& choice : choices) words.emplace_back(choice.word);
  std::string first = words.front();
  return choice_parameter(std::move(name), std::move(first), std::move(words), std::move(description));
}
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

  /// The meaning of a choice parameter's word. Throws std::logic_error if the word is not among `choices`.
  template <typename Meaning, std::size_t n>
  [[nodiscard]] Meaning chosen(std::string_view name, const std::array<Choice<Meaning>, n>& choices) const {
    for (const auto& choice : choices)
      if (choice.word == text(name)) return choice.meaning;
    refuse_choice(name);
  }

  /// The canonical form, from which ids are computed: all values except implied defaults, keys sorted, whole numbers
  /// written as integers.
  [[nodiscard]] nlohmann::json to_json() const;

 private:
  using Value = std::variant<bool, double, std::string>;
  struct Entry {
    std::string name;
    Value value;
    bool implied = false;
  };
  [[nodiscard]] const Value& value(std::string_view name) const;
  [[noreturn]] void refuse_choice(std::string_view name) const;
  std::vector<Entry> entries_;
};

/// The table as JSON Schema "properties" (type, default, minimum, maximum, enum, description).
[[nodiscard]] nlohmann::json schema_properties(std::span<const ParameterSpec> table);

}  // namespace aloft
