#pragma once

#include <nlohmann/json_fwd.hpp>

namespace aloft::experiment {

/// JSON Schema (draft 7) of experiment files, made from the parameter tables of worlds and of the agents linked into
/// this program, for editors. The checks of load() and parse() refuse what it refuses, and what no schema can say
/// (tests/limits/schema_test.cpp).
[[nodiscard]] nlohmann::json experiment_schema();

}  // namespace aloft::experiment
