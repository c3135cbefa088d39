#include "tools/export/scene.hpp"

#include <iterator>

namespace aloft::exports {
namespace {

constexpr double uav_diameter_m = 10.0;
constexpr double mast_width_m = 6.0;
constexpr double text_height_m = 12.0;
constexpr double line_px = 3.0;

void place(foxglove::Pose& pose, const world::Position& position, double height_m) {
  pose.mutable_position()->set_x(position.x_m);
  pose.mutable_position()->set_y(position.y_m);
  pose.mutable_position()->set_z(height_m);
  pose.mutable_orientation()->set_w(1.0);  // not turned
}

void set_size(foxglove::Vector3& size, double width_m, double height_m) {
  size.set_x(width_m);
  size.set_y(width_m);
  size.set_z(height_m);
}

foxglove::SceneEntity& add_entity(foxglove::SceneUpdate& scene, const std::string& id, std::uint64_t time_ns) {
  foxglove::SceneEntity& entity = *scene.add_entities();
  *entity.mutable_timestamp() = timestamp(time_ns);
  entity.set_frame_id(frame);
  entity.set_id(id);
  return entity;
}

void delete_all(foxglove::SceneUpdate& scene, std::uint64_t time_ns) {
  foxglove::SceneEntityDeletion& deletion = *scene.add_deletions();
  *deletion.mutable_timestamp() = timestamp(time_ns);
  deletion.set_type(foxglove::SceneEntityDeletion::ALL);
}

void add_text(foxglove::SceneEntity& entity, const std::string& text, const world::Position& position, double height_m,
              const foxglove::Color& colour) {
  foxglove::TextPrimitive& label = *entity.add_texts();
  place(*label.mutable_pose(), position, height_m);
  label.set_billboard(true);
  label.set_font_size(text_height_m);
  *label.mutable_color() = colour;
  label.set_text(text);
}

foxglove::LinePrimitive& add_line(foxglove::SceneEntity& entity, const foxglove::Color& colour) {
  foxglove::LinePrimitive& line = *entity.add_lines();
  line.set_type(foxglove::LinePrimitive::LINE_STRIP);
  line.mutable_pose()->mutable_orientation()->set_w(1.0);
  line.set_thickness(line_px);
  line.set_scale_invariant(true);
  *line.mutable_color() = colour;
  return line;
}

void add_buildings(foxglove::SceneEntity& entity, const world::City& city) {
  for (std::uint32_t iy = 0; iy < city.buildings_y; ++iy) {
    for (std::uint32_t ix = 0; ix < city.buildings_x; ++ix) {
      const double height_m = city.building_height_m[std::size_t{iy} * city.buildings_x + ix];
      foxglove::CubePrimitive& cube = *entity.add_cubes();
      place(*cube.mutable_pose(), city.building_centre(ix, iy), 0.5 * height_m);
      set_size(*cube.mutable_size(), city.building_width_m, height_m);
      *cube.mutable_color() = colour("#9aa3ad");
    }
  }
}

/// One mast per site, with the numbers of its cells.
void add_stations(foxglove::SceneEntity& entity, const DrawnWorld& world) {
  std::string cells;
  for (auto station = world.stations.begin(); station != world.stations.end(); ++station) {
    const world::Position& position = station->second;
    cells += (cells.empty() ? "" : ", ") + std::to_string(station->first);
    const auto next = std::next(station);
    if (next != world.stations.end() && next->second.x_m == position.x_m && next->second.y_m == position.y_m) continue;
    foxglove::CylinderPrimitive& mast = *entity.add_cylinders();
    place(*mast.mutable_pose(), position, 0.5 * world.antenna_height_m);
    set_size(*mast.mutable_size(), mast_width_m, world.antenna_height_m);
    mast.set_bottom_scale(1.0);
    mast.set_top_scale(0.3);
    *mast.mutable_color() = colour("#c0392b");
    add_text(entity, cells, position, world.antenna_height_m + text_height_m, colour("#c0392b"));
    cells.clear();
  }
}

}  // namespace

google::protobuf::Timestamp timestamp(std::uint64_t time_ns) {
  constexpr std::uint64_t second_ns = 1'000'000'000;
  google::protobuf::Timestamp time;
  time.set_seconds(static_cast<std::int64_t>(time_ns / second_ns));
  time.set_nanos(static_cast<std::int32_t>(time_ns % second_ns));
  return time;
}

foxglove::Color colour(const std::string& hex) {
  const auto part = [&](std::size_t from) { return std::stoi(hex.substr(from, 2), nullptr, 16) / 255.0; };
  foxglove::Color colour;
  colour.set_r(part(1));
  colour.set_g(part(3));
  colour.set_b(part(5));
  colour.set_a(1.0);
  return colour;
}

foxglove::Point3 point(const world::Position& position, double height_m) {
  foxglove::Point3 point;
  point.set_x(position.x_m);
  point.set_y(position.y_m);
  point.set_z(height_m);
  return point;
}

foxglove::SceneUpdate world_scene(const DrawnWorld& world, const std::map<std::string, std::string>& facts,
                                  std::uint64_t time_ns) {
  foxglove::SceneUpdate scene;
  delete_all(scene, time_ns);
  add_buildings(add_entity(scene, "buildings", time_ns), world.city);
  add_stations(add_entity(scene, "base stations", time_ns), world);
  foxglove::LinePrimitive& route = add_line(add_entity(scene, "route", time_ns), colour("#555555"));
  for (const world::Position& position : world.route) *route.add_points() = point(position, 0.0);
  for (foxglove::SceneEntity& entity : *scene.mutable_entities()) {
    for (const auto& [key, value] : facts) {
      foxglove::KeyValuePair& pair = *entity.add_metadata();
      pair.set_key(key);
      pair.set_value(value);
    }
  }
  return scene;
}

foxglove::SceneUpdate flight_scene(const std::vector<foxglove::Point3>& way, const foxglove::Color& colour,
                                   std::uint64_t time_ns) {
  foxglove::SceneUpdate scene;
  delete_all(scene, time_ns);
  foxglove::LinePrimitive& line = add_line(add_entity(scene, "flight", time_ns), colour);
  for (const foxglove::Point3& place : way) *line.add_points() = place;
  return scene;
}

foxglove::SceneUpdate step_scene(const DrawnWorld& world, const flight::StepRecord& step, const std::string& agent,
                                 const foxglove::Color& colour, std::uint64_t time_ns) {
  foxglove::SceneUpdate scene;
  const world::Position position = world.position(step);
  foxglove::SceneEntity& uav = add_entity(scene, "uav", time_ns);
  foxglove::SpherePrimitive& sphere = *uav.add_spheres();
  place(*sphere.mutable_pose(), position, step.height_m);
  set_size(*sphere.mutable_size(), uav_diameter_m, uav_diameter_m);
  *sphere.mutable_color() = colour;
  add_text(uav, agent, position, step.height_m + text_height_m, colour);
  // Without a line it takes away that of the step before.
  foxglove::SceneEntity& beam = add_entity(scene, "serving beam", time_ns);
  if (const auto station = world.stations.find(step.serving_cell); station != world.stations.end()) {
    foxglove::LinePrimitive& line = add_line(beam, colour);
    *line.add_points() = point(position, step.height_m);
    *line.add_points() = point(station->second, world.antenna_height_m);
  }
  return scene;
}

}  // namespace aloft::exports
