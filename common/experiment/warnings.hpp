#pragma once

#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace aloft::experiment {

/// Something that is allowed, but probably not meant.
struct Warning {
  std::string agent;  ///< that it is about; empty: none in particular
  std::string text;   ///< with the condition and what to know about it
};

/// Agents with a network trained beforehand, or a prior fitted beforehand, in worlds that it was not made for, naming
/// the differences; agents that foresee another cell than the one that will serve; and costs that a world cannot
/// charge. Measured flights whose file cannot be read are skipped.
[[nodiscard]] std::vector<Warning> warnings(const Experiment& experiment);

}  // namespace aloft::experiment
