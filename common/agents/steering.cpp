#include "common/agents/steering.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/limits.hpp"

namespace aloft::agents {
namespace {

/// As in reports on the wire (bus/topics.def), or as before the first flight, when all of it is 0.
bool possible(const FlightInfo& flight) noexcept {
  const double range_m = flight.height_max_m - flight.height_min_m;
  return std::fabs(flight.height_min_m) <= limits::height_m && std::fabs(flight.height_max_m) <= limits::height_m &&
         range_m >= 0.0 && range_m <= limits::heights * flight.height_step_m &&
         flight.height_step_m <= limits::height_m;
}

}  // namespace

void save_flight(StateWriter& writer, const FlightInfo& flight) {
  writer.put_integer("flight.qos", static_cast<std::uint64_t>(flight.qos));
  writer.put_number("flight.height_min_m", flight.height_min_m);
  writer.put_number("flight.height_max_m", flight.height_max_m);
  writer.put_number("flight.height_step_m", flight.height_step_m);
  writer.put_integer("flight.steps", flight.steps);
  writer.put_integer("flight.seed", flight.seed);
  writer.put_integer("flight.trial", flight.trial);
}

FlightInfo restore_flight(const StateReader& reader) {
  const std::uint64_t qos = reader.integer("flight.qos");
  if (qos > static_cast<std::uint64_t>(QosKind::throughput)) reader.refuse("it is of an unknown kind of quality");
  FlightInfo flight;
  flight.qos = static_cast<QosKind>(qos);
  flight.height_min_m = reader.number("flight.height_min_m");
  flight.height_max_m = reader.number("flight.height_max_m");
  flight.height_step_m = reader.number("flight.height_step_m");
  flight.steps = static_cast<std::uint32_t>(reader.integer("flight.steps"));
  flight.seed = reader.integer("flight.seed");
  flight.trial = static_cast<std::uint32_t>(reader.integer("flight.trial"));
  if (!possible(flight)) reader.refuse("it is of a flight with impossible heights");
  if (flight.steps > limits::steps) reader.refuse("it is of a flight with too many steps");
  return flight;
}

std::uint32_t level_count(const FlightInfo& flight) noexcept {
  if (!(flight.height_step_m > 0.0)) return 1;
  // Half a millimetre of tolerance: 0.1 m steps are not exact in binary.
  return static_cast<std::uint32_t>((flight.height_max_m - flight.height_min_m + 5e-4) / flight.height_step_m) + 1;
}

std::uint32_t nearest_level(const FlightInfo& flight, double height_m) noexcept {
  if (!(flight.height_step_m > 0.0)) return 0;
  const double level = std::floor((height_m - flight.height_min_m) / flight.height_step_m + 0.5);
  return static_cast<std::uint32_t>(std::clamp(level, 0.0, static_cast<double>(level_count(flight) - 1)));
}

SteeringAgent::SteeringAgent(std::string_view type, Parameters parameters)
    : type_(type), parameters_(std::move(parameters)) {}

void SteeringAgent::begin(const FlightInfo& flight) {
  flight_ = flight;
  height_m_ = flight.height_min_m;
  step_ = 0;
}

void SteeringAgent::observe(const Observation& observation) {
  height_m_ = observation.height_m;
  step_ = observation.step;
}

std::string SteeringAgent::save_state() const {
  StateWriter writer(type_, parameters_);
  save_flight(writer, flight_);
  writer.put_number("height_m", height_m_);
  writer.put_integer("step", step_);
  save(writer);
  return writer.bytes();
}

void SteeringAgent::restore_state(std::string_view bytes) {
  const StateReader reader(bytes, type_, parameters_);
  flight_ = restore_flight(reader);
  height_m_ = reader.number("height_m");
  step_ = static_cast<std::uint32_t>(reader.integer("step"));
  restore(reader);
}

void SteeringAgent::save(StateWriter& /*writer*/) const {}
void SteeringAgent::restore(const StateReader& /*reader*/) {}

}  // namespace aloft::agents
