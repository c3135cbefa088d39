#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace aloft::experiment {

/// Where a document breaks experiment_schema(), one line each with its JSON path; empty if it is valid. For tests.
[[nodiscard]] std::vector<std::string> schema_errors(const nlohmann::json& document);

}  // namespace aloft::experiment
