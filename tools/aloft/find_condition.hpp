#pragma once

#include <string>

#include "common/experiment/experiment.hpp"

namespace aloft::cli {

/// The condition with this index or name, as given to --condition; InputError lists the conditions.
[[nodiscard]] const experiment::Condition& find_condition(const experiment::Experiment& experiment,
                                                          const std::string& wanted);

}  // namespace aloft::cli
