#pragma once

#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace aloft::experiment {

/// Something that is allowed, but probably not meant.
struct Warning {
  std::string agent;  ///< whom it is about; empty: nobody in particular
  std::string text;   ///< with the condition and what to know about it
};

/// Agents with a network trained beforehand in worlds that it was not made for, naming the differences, and costs that
/// a world cannot charge. Measured flights whose file cannot be read are passed over.
[[nodiscard]] std::vector<Warning> warnings(const Experiment& experiment);

}  // namespace aloft::experiment
