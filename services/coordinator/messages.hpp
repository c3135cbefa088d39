#pragma once

#include <string>

#include "common/bus/wire.hpp"
#include "services/coordinator/coordinator.hpp"

/// Conversions between the wire types and those of the coordinator.
namespace aloft::coordinator {

[[nodiscard]] wire::TrialAssignment to_wire(const Order& order, const std::string& experiment_id);
/// Leaves state and message to the caller.
[[nodiscard]] wire::RunStatus to_wire(const Progress& progress, const std::string& experiment_id);
/// `status` must outlive the result.
[[nodiscard]] WorkerNews news_of(const wire::WorkerStatus& status);

}  // namespace aloft::coordinator
