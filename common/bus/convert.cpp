#include "common/bus/convert.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/base/json_text.hpp"
#include "common/radio/generated_world.hpp"

namespace aloft::bus {
namespace {

template <class Ours, class Theirs>
consteval bool same(Ours ours, Theirs theirs) {
  return static_cast<std::uint32_t>(ours) == static_cast<std::uint32_t>(theirs);
}

// An enumerator has the same number in idl/flight.idl and in the domain.
static_assert(same(agents::Action::down, wire::ACTION_DOWN) && same(agents::Action::hold, wire::ACTION_HOLD) &&
              same(agents::Action::up, wire::ACTION_UP) && same(agents::Action::absolute, wire::ACTION_ABSOLUTE));

constexpr std::array privileges{std::pair{agents::Privilege::none, wire::PRIVILEGE_NONE},
                                std::pair{agents::Privilege::site_map, wire::PRIVILEGE_SITE_MAP},
                                std::pair{agents::Privilege::next_step, wire::PRIVILEGE_NEXT_STEP},
                                std::pair{agents::Privilege::whole_route, wire::PRIVILEGE_WHOLE_ROUTE}};

wire::Position to_wire(const world::Position& position) {
  wire::Position message;
  message.x_m(position.x_m);
  message.y_m(position.y_m);
  return message;
}

void put(wire::MeasuredFlight& message, const world::MeasuredSites& known) {
  message.sites().clear();
  message.route().clear();
  wire::MeasuredSite told;
  for (const world::Site& site : known.sites) {
    told.cell(site.cell);
    told.x_m(site.position.x_m);
    told.y_m(site.position.y_m);
    told.azimuth_deg(site.azimuth_deg);
    message.sites().push_back(told);
  }
  for (const world::Position& position : known.route) message.route().push_back(to_wire(position));
  message.antenna_height_m(known.antenna_height_m);
  message.power_w(known.power_w.value_or(0.0));
  message.sectors(known.sectors);
}

world::MeasuredSites measured_sites(const wire::MeasuredFlight& message) {
  world::MeasuredSites known;
  for (const wire::MeasuredSite& site : message.sites())
    known.sites.push_back({site.cell(), {site.x_m(), site.y_m()}, site.azimuth_deg()});
  for (const wire::Position& position : message.route()) known.route.push_back({position.x_m(), position.y_m()});
  known.antenna_height_m = message.antenna_height_m();
  if (message.power_w() > 0.0) known.power_w = message.power_w();
  known.sectors = message.sectors();
  return known;
}

agents::Action from_wire(wire::Action action) {
  if (action > wire::ACTION_ABSOLUTE) throw std::logic_error("convert: this action is no command");
  return static_cast<agents::Action>(action);
}

}  // namespace

void put(wire::ChannelReport& report, const agents::FlightInfo& flight) {
  report.qos_kind(flight.qos == radio::QosKind::throughput ? wire::QOS_THROUGHPUT : wire::QOS_SPECTRAL_EFFICIENCY);
  report.height_min_m(flight.height_min_m);
  report.height_max_m(flight.height_max_m);
  report.height_step_m(flight.height_step_m);
  report.steps(flight.steps);
  report.seed(flight.seed);
  report.trial(flight.trial);
}

void put(wire::ChannelReport& report, const agents::Observation& observation) {
  report.step(observation.step);
  report.height_m(observation.height_m);
  report.serving_cell(observation.serving_cell);
  report.serving_sinr_db(observation.serving_sinr_db);
  const auto neighbours = observation.neighbour_sinr_db.begin();
  report.neighbour_sinr_db().assign(neighbours, neighbours + observation.neighbour_count);
  report.qos(observation.qos);
  report.executed(static_cast<wire::Action>(observation.executed));
  report.reward(observation.reward);
  report.last(observation.last);
}

void put(wire::HeightCommand& message, const agents::Command& command) {
  message.action(static_cast<wire::Action>(command.action));
  message.height_m(command.height_m);
  const std::optional<agents::Introspection> thoughts = agents::showable(command.introspection);
  message.has_introspection(thoughts.has_value());
  const agents::Introspection introspection = thoughts.value_or(agents::Introspection{});
  message.epsilon(introspection.epsilon);
  message.loss(introspection.loss);
  message.q_values(introspection.q_values);
}

void put(wire::HeightProfile& message, const agents::HeightProfile& profile) {
  message.step(profile.step);
  message.height_min_m(profile.height_min_m);
  message.resolution_m(profile.resolution_m);
  message.qos(profile.qos);
}

void put(wire::SiteMap& message, const agents::SiteMap& map) {
  const bool update = !map.radio;
  message.step(map.step);
  message.update(update);
  message.position_error_m(map.known.position_error_m);
  message.missing(map.known.missing);
  message.route_points(map.known.route_points);
  message.route().clear();
  for (const world::Position& position : map.route) {
    wire::RoutePoint point;
    point.x_m(position.x_m);
    point.y_m(position.y_m);
    message.route().push_back(point);
  }
  message.sites().clear();
  message.radio_json().clear();
  if (update) return;
  message.radio_json(wire::bytes(map.radio->to_json().dump()));
  wire::Site told;
  told.antenna_height_m(map.radio->number("base_station_height_m"));
  told.power_w(map.radio->number("tx_power_w"));
  told.antenna(map.radio->text("bs_antenna") == "sector" ? wire::ANTENNA_SECTOR : wire::ANTENNA_ARRAY);
  for (const world::Site& site : map.known.sites) {
    told.cell(site.cell);
    told.x_m(site.position.x_m);
    told.y_m(site.position.y_m);
    told.azimuth_deg(site.azimuth_deg);
    message.sites().push_back(told);
  }
}

void put(wire::World& message, const world::City& city) {
  message.kind(wire::WORLD_CITY);
  wire::City& target = message.city();
  target.window_m(city.window_m);
  target.base_station_height_m(city.base_station_height_m);
  target.base_stations().resize(city.base_stations.size());
  for (std::size_t i = 0; i < city.base_stations.size(); ++i) {
    target.base_stations()[i].x_m(city.base_stations[i].x_m);
    target.base_stations()[i].y_m(city.base_stations[i].y_m);
  }
  target.buildings_x(city.buildings_x);
  target.buildings_y(city.buildings_y);
  target.building_width_m(city.building_width_m);
  target.building_height_m(city.building_height_m);
}

void put(wire::World& message, const world::MeasuredWorld& measured) {
  message.kind(wire::WORLD_MEASURED);
  wire::MeasuredFlight& target = message.measured();
  const world::MeasuredFlight& flight = measured.flight;
  target.height_min_m(flight.height_min_m);
  target.height_step_m(flight.height_step_m);
  target.heights(flight.heights);
  target.steps(flight.steps);
  target.sinr_derived(flight.sinr_derived);
  target.throughput_kbps(flight.throughput_kbps);
  target.sinr_db(flight.sinr_db);
  target.serving_cell(flight.serving_cell);
  put(target, measured.known.value_or(world::MeasuredSites{}));
}

agents::FlightInfo flight_info(const wire::ChannelReport& report) {
  agents::FlightInfo flight;
  flight.qos =
      report.qos_kind() == wire::QOS_THROUGHPUT ? radio::QosKind::throughput : radio::QosKind::spectral_efficiency;
  flight.height_min_m = report.height_min_m();
  flight.height_max_m = report.height_max_m();
  flight.height_step_m = report.height_step_m();
  flight.steps = report.steps();
  flight.seed = report.seed();
  flight.trial = report.trial();
  return flight;
}

agents::Observation observation(const wire::ChannelReport& report) {
  agents::Observation observation;
  observation.step = report.step();
  observation.height_m = report.height_m();
  observation.serving_cell = report.serving_cell();
  observation.serving_sinr_db = report.serving_sinr_db();
  observation.neighbour_count = static_cast<std::uint32_t>(report.neighbour_sinr_db().size());
  std::copy_n(report.neighbour_sinr_db().begin(), observation.neighbour_count, observation.neighbour_sinr_db.begin());
  observation.qos = report.qos();
  observation.executed = from_wire(report.executed());
  observation.reward = report.reward();
  observation.last = report.last();
  return observation;
}

agents::Command command(const wire::HeightCommand& message) {
  agents::Command command;
  command.action = from_wire(message.action());
  command.height_m = message.height_m();
  if (message.has_introspection())
    command.introspection = agents::Introspection{message.epsilon(), message.loss(), message.q_values()};
  return command;
}

agents::HeightProfile profile(const wire::HeightProfile& message) {
  return {message.step(), message.height_min_m(), message.resolution_m(), message.qos()};
}

agents::SiteMap site_map(const wire::SiteMap& message) {
  agents::SiteMap map;
  map.step = message.step();
  if (!message.update())
    map.radio =
        radio::resolve_generated_world(parse_json(wire::view(message.radio_json()), "radio_json"), "radio_json");
  map.known.position_error_m = message.position_error_m();
  map.known.missing = message.missing();
  map.known.route_points = message.route_points();
  for (const wire::Site& site : message.sites())
    map.known.sites.push_back({site.cell(), {site.x_m(), site.y_m()}, site.azimuth_deg()});
  for (const wire::RoutePoint& point : message.route()) map.route.push_back({point.x_m(), point.y_m()});
  return map;
}

world::City city(const wire::World& message) {
  const wire::City& source = message.city();
  world::City city;
  city.window_m = source.window_m();
  city.base_station_height_m = source.base_station_height_m();
  city.base_stations.reserve(source.base_stations().size());
  for (const wire::Position& position : source.base_stations())
    city.base_stations.push_back({position.x_m(), position.y_m()});
  city.buildings_x = source.buildings_x();
  city.buildings_y = source.buildings_y();
  city.building_width_m = source.building_width_m();
  city.building_height_m = source.building_height_m();
  return city;
}

world::MeasuredWorld measured_world(const wire::World& message) {
  const wire::MeasuredFlight& source = message.measured();
  world::MeasuredWorld measured;
  world::MeasuredFlight& flight = measured.flight;
  flight.height_min_m = source.height_min_m();
  flight.height_step_m = source.height_step_m();
  flight.heights = source.heights();
  flight.steps = source.steps();
  flight.sinr_derived = source.sinr_derived();
  flight.throughput_kbps = source.throughput_kbps();
  flight.sinr_db = source.sinr_db();
  flight.serving_cell = source.serving_cell();
  if (!source.sites().empty()) measured.known = measured_sites(source);
  return measured;
}

wire::ProcessName to_wire(const ProcessName& process) {
  wire::ProcessName message;
  message.incarnation(process.incarnation);
  message.host(wire::name(process.host));
  message.pid(process.pid);
  message.since_s(process.since_s);
  return message;
}

ProcessName from_wire(const wire::ProcessName& process) {
  return {process.incarnation(), std::string(wire::view(process.host())), process.pid(), process.since_s()};
}

wire::Privilege to_wire(agents::Privilege privilege) {
  return std::ranges::find(privileges, privilege, [](const auto& pair) { return pair.first; })->second;
}

agents::Privilege from_wire(wire::Privilege privilege) {
  return std::ranges::find(privileges, privilege, [](const auto& pair) { return pair.second; })->first;
}

}  // namespace aloft::bus
