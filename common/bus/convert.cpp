#include "common/bus/convert.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace aloft::bus {
namespace {

template <class Ours, class Theirs>
consteval bool same(Ours ours, Theirs theirs) {
  return static_cast<std::uint32_t>(ours) == static_cast<std::uint32_t>(theirs);
}

// An enumerator has the same number in idl/flight.idl and in the domain.
static_assert(same(agents::Action::down, wire::ACTION_DOWN) && same(agents::Action::hold, wire::ACTION_HOLD) &&
              same(agents::Action::up, wire::ACTION_UP) && same(agents::Action::absolute, wire::ACTION_ABSOLUTE) &&
              same(agents::Privilege::next_step, wire::PRIVILEGE_NEXT_STEP) &&
              same(agents::Privilege::whole_route, wire::PRIVILEGE_WHOLE_ROUTE));

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

void put(wire::World& message, const world::MeasuredFlight& flight) {
  message.kind(wire::WORLD_MEASURED);
  wire::MeasuredFlight& target = message.measured();
  target.height_min_m(flight.height_min_m);
  target.height_step_m(flight.height_step_m);
  target.heights(flight.heights);
  target.steps(flight.steps);
  target.sinr_derived(flight.sinr_derived);
  target.throughput_kbps(flight.throughput_kbps);
  target.sinr_db(flight.sinr_db);
  target.serving_cell(flight.serving_cell);
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

world::MeasuredFlight measured_flight(const wire::World& message) {
  const wire::MeasuredFlight& source = message.measured();
  world::MeasuredFlight flight;
  flight.height_min_m = source.height_min_m();
  flight.height_step_m = source.height_step_m();
  flight.heights = source.heights();
  flight.steps = source.steps();
  flight.sinr_derived = source.sinr_derived();
  flight.throughput_kbps = source.throughput_kbps();
  flight.sinr_db = source.sinr_db();
  flight.serving_cell = source.serving_cell();
  return flight;
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
  return static_cast<wire::Privilege>(privilege);
}

agents::Privilege from_wire(wire::Privilege privilege) {
  return static_cast<agents::Privilege>(privilege);
}

}  // namespace aloft::bus
