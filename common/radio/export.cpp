#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "common/base/error.hpp"
#include "common/radio/inspect.hpp"
#include "common/world/route.hpp"

namespace aloft::radio {
namespace {

using Json = nlohmann::json;

/// Calls `visit(point, position, column)` along the route.
template <typename Visit>
void for_each_column(SignalMap& map, Visit visit) {
  if (!map.fixed_route())
    throw InputError(
        "the route rule 'serving' makes the route depend on the flight, so there is no table of the whole route; use "
        "the route rule 'nearest'");
  const std::uint32_t last = map.result_point(map.steps());
  for (std::uint32_t point = 0; point <= last; ++point) {
    const world::Position position = map.advance(point, map.start(), -1);
    visit(point, position, map.column(point, position));
  }
}

const char* qos_name(const SignalMap& map) {
  return map.qos_kind() == QosKind::throughput ? "throughput_kbps" : "spectral_efficiency";
}

}  // namespace

Json world_to_json(const Parameters& world, const world::City& city) {
  Json stations = Json::array();
  for (const world::Position& station : city.base_stations)
    stations.push_back({{"x_m", station.x_m}, {"y_m", station.y_m}, {"height_m", city.base_station_height_m}});
  Json buildings = Json::array();
  for (std::uint32_t iy = 0; iy < city.buildings_y; ++iy) {
    for (std::uint32_t ix = 0; ix < city.buildings_x; ++ix) {
      const world::Position centre = city.building_centre(ix, iy);
      buildings.push_back({{"x_m", centre.x_m},
                           {"y_m", centre.y_m},
                           {"height_m", city.building_height_m[std::size_t{iy} * city.buildings_x + ix]}});
    }
  }
  Json points;
  const world::Route route(world, city);
  for (std::uint32_t point = 0; route.fixed() && point <= route.steps(); ++point) {
    const world::Position position = route.advance(point, route.start(), -1);
    points.push_back({{"x_m", position.x_m}, {"y_m", position.y_m}});
  }
  return {{"window_m", city.window_m},
          {"building_width_m", city.building_width_m},
          {"base_stations", stations},
          {"buildings", buildings},
          {"route", points}};
}

void write_world_csv(std::ostream& out, const Parameters& world, const world::City& city) {
  const Json json = world_to_json(world, city);
  out << "kind,index,x_m,y_m,height_m\n";
  const auto write = [&](const char* kind, const Json& rows) {
    std::size_t index = 0;
    for (const Json& row : rows)
      out << fmt::format("{},{},{},{},{}\n", kind, index++, row["x_m"].get<double>(), row["y_m"].get<double>(),
                         row.contains("height_m") ? fmt::format("{}", row["height_m"].get<double>()) : "");
  };
  write("base_station", json["base_stations"]);
  write("building", json["buildings"]);
  write("route_point", json["route"]);
}

void write_table_json(std::ostream& out, SignalMap& map) {
  Json heights = Json::array();
  for (std::uint32_t i = 0; i < map.heights().size(); ++i) heights.push_back(map.heights().height_m(i));
  Json points = Json::array();
  for_each_column(map, [&](std::uint32_t point, world::Position position, const std::vector<Reading>& column) {
    Json entry{{"point", point}, {"x_m", position.x_m}, {"y_m", position.y_m}};
    for (const Reading& reading : column) {
      entry[qos_name(map)].push_back(reading.qos);
      entry["serving_sinr_db"].push_back(reading.serving_sinr_db);
      entry["serving_cell"].push_back(reading.serving_cell);
    }
    points.push_back(std::move(entry));
  });
  out << Json{{"heights_m", heights}, {"points", points}} << "\n";
}

void write_table_csv(std::ostream& out, SignalMap& map) {
  out << "point,x_m,y_m,height_m," << qos_name(map) << ",serving_sinr_db,serving_cell\n";
  for_each_column(map, [&](std::uint32_t point, world::Position position, const std::vector<Reading>& column) {
    for (std::uint32_t i = 0; i < column.size(); ++i)
      out << fmt::format("{},{},{},{},{},{},{}\n", point, position.x_m, position.y_m, map.heights().height_m(i),
                         column[i].qos, column[i].serving_sinr_db, column[i].serving_cell);
  });
}

}  // namespace aloft::radio
