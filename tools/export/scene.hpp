#pragma once

#include <tools/export/foxglove.pb.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/export/drawn_world.hpp"

namespace aloft::exports {

/// The frame of reference of everything drawn: metres to the east, to the north, and above the ground.
inline constexpr const char* frame = "world";

[[nodiscard]] google::protobuf::Timestamp timestamp(std::uint64_t time_ns);

/// From a colour as in "#2a9fd0".
[[nodiscard]] foxglove::Color colour(const std::string& hex);

/// A place above the ground, m.
[[nodiscard]] foxglove::Point3 point(const world::Position& position, double height_m);

/// Buildings, base stations and the route, instead of what was drawn before. `facts` are shown of each of them.
[[nodiscard]] foxglove::SceneUpdate world_scene(const DrawnWorld& world,
                                                const std::map<std::string, std::string>& facts, std::uint64_t time_ns);

/// The way of a whole flight, instead of what was drawn before of this agent.
[[nodiscard]] foxglove::SceneUpdate flight_scene(const std::vector<foxglove::Point3>& way,
                                                 const foxglove::Color& colour, std::uint64_t time_ns);

/// The UAV with the agent's name, and the line to its serving base station if that is known.
[[nodiscard]] foxglove::SceneUpdate step_scene(const DrawnWorld& world, const flight::StepRecord& step,
                                               const std::string& agent, const foxglove::Color& colour,
                                               std::uint64_t time_ns);

}  // namespace aloft::exports
