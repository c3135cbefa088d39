#include "common/experiment/trial_world.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/experiment/measured_files.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/measured_map.hpp"
#include "common/world/city.hpp"

namespace aloft::experiment {

world::City make_city(const Experiment& experiment, const Condition& condition, std::uint32_t trial) {
  return world::generate_city(condition.world, experiment.seed, trial);
}

PlacedWorld read_placed_world(const Condition& condition) {
  constexpr std::string_view advice = "use the original file on every machine, or start a new experiment";
  NamedFile file{condition.world.text("file"), condition.world.text("file_sha256")};
  NamedFile sites{condition.world.text("sites_file"), condition.world.text("sites_file_sha256")};
  world::LocatedFlight located = read_flight(file, advice);
  PlacedWorld placed;
  if (!sites.path.empty()) placed.world.known = read_sites(sites, located, file.path, advice);
  placed.world.flight = std::move(located.flight);
  placed.places = std::move(located.route);
  return placed;
}

world::MeasuredWorld read_measured_world(const Condition& condition) {
  return read_placed_world(condition).world;
}

TrialWorld make_world(const Experiment& experiment, const Condition& condition, std::uint32_t trial) {
  if (condition.kind == WorldKind::measured) return read_measured_world(condition);
  return make_city(experiment, condition, trial);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Condition& condition, std::uint64_t seed, std::uint32_t trial,
                                                  const TrialWorld& world) {
  const auto* const measured = std::get_if<world::MeasuredWorld>(&world);
  if ((condition.kind == WorldKind::measured) != (measured != nullptr))
    throw std::runtime_error("the world is not of the condition's kind");
  if (measured != nullptr) return radio::make_measured_map(measured->flight, measured->known);
  const auto& city = std::get<world::City>(world);
  if (std::cmp_less(city.base_stations.size(), condition.world.integer("min_base_stations")))
    throw std::runtime_error("the city has fewer base stations than the condition asks for");
  return radio::make_generated_map(condition.world, city, seed, trial);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition,
                                                  std::uint32_t trial, const TrialWorld& world) {
  return make_signal_map(condition, experiment.seed, trial, world);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition,
                                                  std::uint32_t trial) {
  return make_signal_map(experiment, condition, trial, make_world(experiment, condition, trial));
}

}  // namespace aloft::experiment
