#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/store/result_store.hpp"

namespace aloft::report {

/// The trial of a condition to show: `wanted` if given, else the first one that most agents have flown. None if that
/// trial has no flight.
[[nodiscard]] std::optional<std::uint32_t> trial_to_show(const store::ResultStore& results, std::uint32_t condition,
                                                         std::optional<std::uint32_t> wanted);

/// What is told of each agent's steps.
enum class Quantities {
  charted,  ///< what the report shows; it has many flights in one file
  all       ///< also "sinr_db": [...] and "reward": [...] of each agent
};

/// One trial of a condition as all its agents flew it, and the world below them:
/// {"trial", "step": [1...], "height_min_m", "height_max_m", "height_step_m",
///  "agents": [{"name", "height_m": [...], "qos": [...], "serving_cell": [...], "x_m": [...], "y_m": [...],
///              "learning": null | {"epsilon": [...], "loss": [...], "q_down": [...], "q_hold": [...], "q_up":
///              [...]}}],
///  "map": {"height_m": [...], "qos": [[one per height] per step]},
///  "city": null | {"building_width_m", "base_station_height_m", "base_stations": [[x, y]...],
///                  "buildings": [[x, y, height]...]}}
[[nodiscard]] nlohmann::json flight_view(const store::ResultStore& results, std::uint32_t condition,
                                         std::uint32_t trial, Quantities quantities = Quantities::charted);

/// The world of a trial before it is flown: {"city": as above, "route": null | {"x_m", "y_m": [one per step]}, "map":
/// as above | null}. The route is null if it depends on the flight, and so is the map, also if no agent of the
/// experiment sees the future.
[[nodiscard]] nlohmann::json world_view(const experiment::Experiment& experiment, std::uint32_t condition,
                                        std::uint32_t trial);

}  // namespace aloft::report
