#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace aloft::experiment {

/// Applies one `--set json.path=value` to an experiment file: array entries by number (worlds.1.file), the value JSON
/// or else a text. The last key of the path may be new; later checks refuse an unknown one. Throws InputError if
/// another part of the path does not exist.
void set_value(nlohmann::ordered_json& document, const std::string& assignment);

}  // namespace aloft::experiment
