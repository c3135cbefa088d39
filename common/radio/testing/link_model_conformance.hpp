#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/radio/models/link_model.hpp"

namespace aloft::radio {

/// Checks every promise of a channel model: gains that are positive, finite and within their bound; rows with the bits
/// of single elements, over heights and over base stations; the same answers in another object of the same trial and in
/// another order; blocking heights that are numbers, and line of sight that begins there; shadowing within what it says
/// of itself; a name and a description. `world`: keys of a generated world with this model. Returns what is wrong and
/// where to look, one sentence each; nothing if the model conforms.
[[nodiscard]] std::vector<std::string> link_model_problems(const LinkModelType& type,
                                                           const nlohmann::json& world = nlohmann::json::object());
/// The same as Catch2 checks, for a registered model.
void check_link_model(std::string_view name, const nlohmann::json& world = nlohmann::json::object());

/// Mean gain by a registered model of one link without buildings, base station at 30 m, for tests of its formulas.
[[nodiscard]] double mean_gain(std::string_view name, const nlohmann::json& world, double distance_m, double height_m,
                               bool line_of_sight);

}  // namespace aloft::radio
