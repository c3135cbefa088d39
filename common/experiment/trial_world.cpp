#include "common/experiment/trial_world.hpp"

#include <fmt/format.h>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
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
  if (const std::string sha256 = sha256_hex(csv); sha256 != condition.world.text("file_sha256"))
    throw InputError(
        fmt::format("'{}' has changed since the experiment was resolved: its SHA-256 is {}, not {}; bring "
                    "the original file back, or start a new experiment",
                    file, sha256, condition.world.text("file_sha256")));
  return world::parse_measured_flight(csv, file);
}

std::unique_ptr<radio::SignalMap> make_signal_map(const Experiment& experiment, const Condition& condition,
                                                  std::uint32_t trial) {
  if (condition.kind == WorldKind::measured) return radio::make_measured_map(read_measured_flight(condition));
  return radio::make_generated_map(condition.world, make_city(experiment, condition, trial), experiment.seed, trial);
}

}  // namespace aloft::experiment
