#include "tools/report/flight_view.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "common/experiment/trial_world.hpp"
#include "common/world/city.hpp"
#include "tools/report/statistics_view.hpp"
#include "tools/report/trials.hpp"

namespace aloft::report {
namespace {

using nlohmann::json;

/// Distance of heights in the heat map, unless the world's own grid is coarser.
constexpr double map_resolution_m = 5.0;

struct Flown {
  std::string agent;
  flight::FlightRecord record;
};

/// All stored flights of this trial in the order of display.
std::vector<Flown> read_flights(const store::ResultStore& results, std::uint32_t condition, std::uint32_t trial) {
  std::vector<Flown> flown;
  for (const experiment::FlightKey& key : results.keys())
    if (key.condition == condition && key.trial == trial)
      flown.push_back({key.agent, store::decode_trace(results.trace(key))});
  const auto rank = [&](const Flown& one) {
    return agents::agent_type(results.experiment().agent(one.agent).type).rank_of(one.agent);
  };
  std::ranges::stable_sort(flown, [&](const Flown& a, const Flown& b) { return rank(a) < rank(b); });
  return flown;
}

json learning_curves(const flight::FlightRecord& record) {
  const bool learns =
      std::ranges::any_of(record.steps, [](const auto& step) { return step.introspection.has_value(); });
  if (!learns) return nullptr;
  json curves;
  for (const flight::StepRecord& step : record.steps) {
    const auto add = [&](const char* curve, auto part) {
      curves[curve].push_back(step.introspection ? significant(part(*step.introspection)) : json());
    };
    add("epsilon", [](const agents::Introspection& i) { return i.epsilon; });
    add("loss", [](const agents::Introspection& i) { return i.loss; });
    add("q_down", [](const agents::Introspection& i) { return i.q_values[0]; });
    add("q_hold", [](const agents::Introspection& i) { return i.q_values[1]; });
    add("q_up", [](const agents::Introspection& i) { return i.q_values[2]; });
  }
  return curves;
}

json agent_track(const Flown& flown, double scale, Quantities quantities) {
  json track{{"name", flown.agent},
             {"height_m", json::array()},
             {"qos", json::array()},
             {"serving_cell", json::array()},
             {"x_m", json::array()},
             {"y_m", json::array()},
             {"learning", learning_curves(flown.record)}};
  for (const flight::StepRecord& step : flown.record.steps) {
    track["height_m"].push_back(rounded(step.height_m));
    track["qos"].push_back(rounded(step.qos * scale));
    track["serving_cell"].push_back(step.serving_cell);
    track["x_m"].push_back(rounded(step.x_m));
    track["y_m"].push_back(rounded(step.y_m));
  }
  if (quantities == Quantities::all)
    for (const flight::StepRecord& step : flown.record.steps) {
      track["sinr_db"].push_back(rounded(step.serving_sinr_db));
      track["reward"].push_back(rounded(step.reward * scale));
    }
  return track;
}

/// QoS at the place of each step, over all heights. `places`: [step - 1].
json quality_map(radio::SignalMap& map, const std::vector<world::Position>& places, double scale) {
  const radio::HeightGrid& grid = map.heights();
  const auto stride = std::max(1U, static_cast<std::uint32_t>(std::lround(map_resolution_m / grid.resolution_m)));
  json heights = json::array();
  for (std::uint32_t k = 0; k < grid.size(); k += stride) heights.push_back(rounded(grid.height_m(k)));
  json columns = json::array();
  for (std::uint32_t step = 1; step <= places.size(); ++step) {
    const std::vector<radio::Reading>& readings = map.column(map.result_point(step), places[step - 1]);
    json column = json::array();
    for (std::uint32_t k = 0; k < grid.size(); k += stride)
      column.push_back(std::round(readings[k].qos * scale * 100) / 100);
    columns.push_back(std::move(column));
  }
  return {{"height_m", std::move(heights)}, {"qos", std::move(columns)}};
}

/// Base stations and buildings of the city from which the trial's signal map was made.
json city_view(const experiment::Experiment& experiment, const experiment::Condition& condition, std::uint32_t trial) {
  if (condition.kind != experiment::WorldKind::generated) return nullptr;
  const world::City city = world::generate_city(condition.world, experiment.seed, trial);
  json stations = json::array();
  for (const world::Position& station : city.base_stations)
    stations.push_back({std::round(station.x_m), std::round(station.y_m)});
  json buildings = json::array();
  for (std::uint32_t iy = 0; iy < city.buildings_y; ++iy)
    for (std::uint32_t ix = 0; ix < city.buildings_x; ++ix) {
      const world::Position centre = city.building_centre(ix, iy);
      buildings.push_back({std::round(centre.x_m), std::round(centre.y_m),
                           std::round(city.building_height_m[iy * city.buildings_x + ix])});
    }
  return {{"building_width_m", city.building_width_m},
          {"base_station_height_m", city.base_station_height_m},
          {"base_stations", std::move(stations)},
          {"buildings", std::move(buildings)}};
}

}  // namespace

std::optional<std::uint32_t> trial_to_show(const store::ResultStore& results, std::uint32_t condition,
                                           std::optional<std::uint32_t> wanted) {
  std::map<std::uint32_t, std::size_t> agents;
  for (const experiment::FlightKey& key : results.keys())
    if (key.condition == condition) ++agents[key.trial];
  if (wanted) return agents.contains(*wanted) ? wanted : std::nullopt;
  const auto best = std::ranges::max_element(agents, [](const auto& a, const auto& b) { return a.second < b.second; });
  return best == agents.end() ? std::nullopt : std::optional(best->first);
}

nlohmann::json flight_view(const store::ResultStore& results, std::uint32_t condition, std::uint32_t trial,
                           Quantities quantities) {
  const experiment::Experiment& experiment = results.experiment();
  const double scale = qos_scale(experiment.conditions.at(condition).kind);
  const auto map = experiment::make_signal_map(experiment, experiment.conditions.at(condition), trial);
  const std::vector<Flown> flights = read_flights(results, condition, trial);
  const radio::HeightGrid& grid = map->heights();
  std::vector<world::Position> places;
  for (const flight::StepRecord& step : flights.back().record.steps) places.push_back({step.x_m, step.y_m});
  json view{{"trial", trial},
            {"step", json::array()},
            {"height_min_m", grid.height_min_m},
            {"height_max_m", grid.height_max_m},
            {"height_step_m", grid.height_step_m},
            {"agents", json::array()},
            {"map", quality_map(*map, places, scale)},
            {"city", city_view(experiment, experiment.conditions.at(condition), trial)}};
  for (const flight::StepRecord& step : flights.back().record.steps) view["step"].push_back(step.step);
  for (const Flown& flown : flights) view["agents"].push_back(agent_track(flown, scale, quantities));
  return view;
}

nlohmann::json world_view(const experiment::Experiment& experiment, std::uint32_t condition, std::uint32_t trial) {
  const experiment::Condition& place = experiment.conditions.at(condition);
  const auto map = experiment::make_signal_map(experiment, place, trial);
  json view{{"city", city_view(experiment, place, trial)}, {"route", nullptr}, {"map", nullptr}};
  if (!map->fixed_route()) return view;
  std::vector<world::Position> places;
  json xs = json::array();
  json ys = json::array();
  for (std::uint32_t step = 1; step <= map->steps(); ++step) {
    constexpr std::int32_t any_cell = -1;
    places.push_back(map->advance(map->result_point(step), places.empty() ? map->start() : places.back(), any_cell));
    xs.push_back(rounded(places.back().x_m));
    ys.push_back(rounded(places.back().y_m));
  }
  view["route"] = {{"x_m", std::move(xs)}, {"y_m", std::move(ys)}};
  const bool foreseen = std::ranges::any_of(
      experiment.agents, [](const agents::AgentSpec& agent) { return agents::foresees(agent.privilege()); });
  if (foreseen) view["map"] = quality_map(*map, places, qos_scale(place.kind));
  return view;
}

}  // namespace aloft::report
