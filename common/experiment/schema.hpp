#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace aloft::experiment {

/// JSON Schema (draft 7) of experiment files, made from the parameter tables of worlds and of the agents linked into
/// this program.
[[nodiscard]] nlohmann::json experiment_schema();

/// Where a document breaks that schema, one line each with its JSON path; empty if it is valid.
[[nodiscard]] std::vector<std::string> schema_errors(const nlohmann::json& document);

}  // namespace aloft::experiment
