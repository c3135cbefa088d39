#include "common/experiment/trial_world.hpp"

#include <stdexcept>
#include <utility>

#include "common/base/digest.hpp"
#include "common/base/read_file.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/measured_map.hpp"
#include "common/world/city.hpp"
#include "common/world/measured_flight.hpp"

namespace aloft::experiment {

world::City make_city(const Experiment& experiment, const Condition& condition, std::uint32_t trial) {
  return world::generate_city(condition.world, experiment.seed, trial);
}

world::MeasuredFlight read_measured_flight(const Condition& condition) {
  const std::string& file = condition.world.text("file");
  const std::string csv = read_file(file);
  check_unchanged(file, csv, condition.world.text("file_sha256"),
                  "use the original file on every machine, or start a new experiment");
  return world::parse_measured_flight(csv, file);
}

TrialWorld make_world(const Experiment& experiment, const Condition& condition, std::uint32_t trial) {
  if (condition.kind == WorldKind::measured) return read_measured_flight(condition);
  return make_city(experiment, condition, trial);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition,
                                                  std::uint32_t trial, const TrialWorld& world) {
  const auto* const flight = std::get_if<world::MeasuredFlight>(&world);
  if ((condition.kind == WorldKind::measured) != (flight != nullptr))
    throw std::runtime_error("the world is not of the condition's kind");
  if (flight != nullptr) return radio::make_measured_map(*flight);
  const auto& city = std::get<world::City>(world);
  if (std::cmp_less(city.base_stations.size(), condition.world.integer("min_base_stations")))
    throw std::runtime_error("the city has fewer base stations than the condition asks for");
  return radio::make_generated_map(condition.world, city, experiment.seed, trial);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition,
                                                  std::uint32_t trial) {
  return make_signal_map(experiment, condition, trial, make_world(experiment, condition, trial));
}

}  // namespace aloft::experiment
