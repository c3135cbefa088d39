#pragma once

#include <string>

#include "common/bus/wire.hpp"
#include "services/coordinator/coordinator.hpp"

/// Between what is on the wire and what a coordinator knows.
namespace aloft::coordinator {

[[nodiscard]] wire::TrialAssignment to_wire(const Order& order, const std::string& experiment_id);
/// Without state and message, which are not always those of the progress.
[[nodiscard]] wire::RunStatus to_wire(const Progress& progress, const std::string& experiment_id);
/// `status` must outlive it.
[[nodiscard]] WorkerNews news_of(const wire::WorkerStatus& status);

}  // namespace aloft::coordinator
