#include "tools/aloft/find_condition.hpp"

#include <fmt/format.h>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::cli {

const experiment::Condition& find_condition(const experiment::Experiment& experiment, const std::string& wanted) {
  constexpr std::uint32_t shown = 20;
  std::string known;
  for (const experiment::Condition& condition : experiment.conditions) {
    if (condition.name == wanted || std::to_string(condition.index) == wanted) return condition;
    if (condition.index < shown) known += fmt::format("\n  {}  {}", condition.index, condition.name);
  }
  if (experiment.conditions.size() > shown) known += fmt::format("\n  ... up to {}", experiment.conditions.size() - 1);
  throw InputError("--condition {}: there is no such condition; use one of{}", excerpt(wanted), known);
}

}  // namespace aloft::cli
