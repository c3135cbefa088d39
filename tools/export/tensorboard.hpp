#pragma once

#include <filesystem>
#include <span>

#include "common/store/result_store.hpp"

namespace aloft::exports {

/// Writes stored flights as event files for TensorBoard: one run per flight, in
/// FOLDER/CONDITION/trial-TRIAL/AGENT, with curves over the steps: what happened (flight/...), and what the agent told
/// of its learning (learning/...). Times are those of the flight, so that the same flights give the same bytes. Throws
/// InputError if the folder exists or cannot be written, IntegrityError as ResultStore::trace(); then no folder is
/// left.
void write_events(const store::ResultStore& results, std::span<const store::FlightSummary> flights,
                  const std::filesystem::path& folder);

/// The same of the validation log of 'aloft train': one run per network, with curves over the rounds. InputError also
/// if the file is no such log.
void write_training_events(const std::filesystem::path& log, const std::filesystem::path& folder);

}  // namespace aloft::exports
