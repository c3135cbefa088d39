#pragma once

#include <nlohmann/json_fwd.hpp>

namespace aloft::experiment {

/// JSON Schema (draft 7) of experiment files, made from the parameter tables of worlds and of the agents linked into
/// this program, for editors. load() and parse() refuse all that it refuses, and what a schema cannot express
/// (tests/limits/schema_test.cpp).
[[nodiscard]] nlohmann::json experiment_schema();

}  // namespace aloft::experiment
