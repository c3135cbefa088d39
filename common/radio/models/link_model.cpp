#include "common/radio/models/link_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace aloft::radio {
namespace {

/// Every model's file adds its own entry while the program starts, in any order.
std::vector<LinkModelType>& registered_models() {
  static std::vector<LinkModelType> types;
  return types;
}

}  // namespace

Shadowing LinkModel::shadowing(const LinkPlace& /*link*/, bool /*line_of_sight*/, double /*height_m*/) const {
  return {};
}

bool register_link_model(LinkModelType type) {
  auto& types = registered_models();
  const auto after = std::ranges::upper_bound(types, type.name, {}, &LinkModelType::name);
  types.insert(after, std::move(type));
  return true;
}

std::span<const LinkModelType> link_model_types() {
  return registered_models();
}

const LinkModelType& link_model_type(std::string_view name) {
  for (const LinkModelType& type : registered_models())
    if (type.name == name) return type;
  throw std::logic_error(fmt::format("no channel model '{}'", name));
}

}  // namespace aloft::radio
