#pragma once

#include <filesystem>
#include <span>

#include "common/store/result_store.hpp"

namespace aloft::exports {

/// Writes stored flights as an MCAP file for Foxglove. The worlds follow each other in time; the agents of a world fly
/// side by side. A step lasts as long as its route takes at the experiment's speed, and the first world begins at time
/// 0, so that the same flights give the same bytes. Topics, all in Protobuf:
///   /world           foxglove.SceneUpdate at the beginning of each world: buildings, base stations, route
///   /AGENT/scene     foxglove.SceneUpdate: the whole way at the beginning, then the UAV and its serving beam
///   /AGENT/location  foxglove.LocationFix, see DrawnWorld::place()
///   /AGENT/step      aloft.Step
/// `flights`: in canonical order. Throws InputError if the file cannot be written or a world cannot be made anew,
/// IntegrityError as ResultStore::trace(); then no file is left.
void write_recording(const store::ResultStore& results, std::span<const store::FlightSummary> flights,
                     const std::filesystem::path& file);

}  // namespace aloft::exports
