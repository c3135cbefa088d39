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

bool LinkModel::line_of_sight(const LinkPlace& link, double height_m) const {
  return height_m >= blocking_height_m(link);
}

void LinkModel::mean_gains(world::Position uav, std::span<const double> distance_m, bool line_of_sight, double height_m,
                           double* gain) const {
  for (std::uint32_t k = 0; k < distance_m.size(); ++k)
    mean_gain_row({uav, k, distance_m[k]}, line_of_sight, std::span(&height_m, 1), gain + k);
}

Shadowing LinkModel::shadowing(bool /*line_of_sight*/) const {
  return {};
}

void LinkModel::shadowing_row(const LinkPlace& /*link*/, bool /*line_of_sight*/, std::span<const double> height_m,
                              double* deviation_db) const {
  std::fill_n(deviation_db, height_m.size(), 0.0);
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
