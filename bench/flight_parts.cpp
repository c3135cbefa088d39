// Where the time of a flight goes, without the bus: CPU milliseconds of each part per 100-step flight over generated
// cities, as a Markdown table; and of the SE table, which agents with foresight need besides. The bus and the processes
// around it: tools/performance.sh.

#include <fmt/format.h>
#include <stdlib.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/shortest_turn.hpp"
#include "common/base/error.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"
#include "common/radio/generated_map.hpp"
#include "common/store/result_store.hpp"

using namespace aloft;

namespace {

constexpr std::uint32_t trials = 10;

experiment::Experiment one_condition() {
  const nlohmann::json document{
      {"name", "flight-parts"},
      {"seed", 1},
      {"trials", trials},
      {"world", {{"kind", "generated"}, {"bs_density_per_km2", 5}, {"building_density_per_km2", 200}}},
      {"agents", {"min-height", "dqn"}}};
  return experiment::parse(document.dump(), "flight-parts");
}

template <typename Run>
double seconds_of(Run run) {
  const double start_s = bench::thread_seconds();
  run();
  return bench::thread_seconds() - start_s;
}

struct Parts {
  double city_s = 0, table_s = 0, readings_s = 0, simulation_s = 0, learning_s = 0, encoding_s = 0, storing_s = 0;
};

flight::FlightRecord fly(radio::SignalMap& map, const experiment::Experiment& experiment, std::uint32_t trial,
                         const agents::AgentSpec& spec) {
  return flight::fly(map, experiment.seed, trial, *spec.make(), spec);
}

void add_trial(Parts& parts, const experiment::Experiment& experiment, std::uint32_t trial,
               store::ResultStore& results) {
  const experiment::Condition& condition = experiment.conditions.front();
  std::unique_ptr<radio::SignalMap> map;
  parts.city_s += seconds_of([&] { map = experiment::make_signal_map(experiment, condition, trial); });
  const double reading_s = seconds_of([&] { (void)fly(*map, experiment, trial, experiment.agents[0]); });
  parts.table_s += seconds_of([&] { map->prepare(); });
  const double alone_s = seconds_of([&] { (void)fly(*map, experiment, trial, experiment.agents[0]); });
  parts.readings_s += reading_s - alone_s;
  flight::FlightRecord record;
  const double dqn_s = seconds_of([&] { record = fly(*map, experiment, trial, experiment.agents[1]); });
  parts.simulation_s += alone_s;
  parts.learning_s += dqn_s - alone_s;
  std::string trace;
  parts.encoding_s += seconds_of([&] { trace = store::encode_trace(record); });
  parts.storing_s += seconds_of([&] { (void)results.add({0, trial, experiment.agents[1].name}, trace); });
}

}  // namespace

int main() {
  std::string folder = (std::filesystem::temp_directory_path() / "flight-parts-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw InputError("cannot create a temporary folder");
  const experiment::Experiment experiment = one_condition();
  Parts parts;
  {
    auto results = store::ResultStore::open_for_writing(folder, experiment);
    for (std::uint32_t trial = 0; trial < trials; ++trial) add_trial(parts, experiment, trial, results);
  }
  std::filesystem::remove_all(folder);

  const std::vector<std::pair<const char*, double>> rows{
      {"the DQN: 16,000 gradient steps, decisions", parts.learning_s},
      {"101 readings of the radio", parts.readings_s},
      {"city (once per trial)", parts.city_s},
      {"storing the flight durably, alone", parts.storing_s},
      {"encoding it", parts.encoding_s},
      {"simulating 100 steps", parts.simulation_s}};
  double sum_s = 0.0;
  for (const auto& [name, part_s] : rows) sum_s += part_s;
  fmt::print("| part | ms per flight | share |\n|---|---|---|\n");
  for (const auto& [name, part_s] : rows)
    fmt::print("| {} | {:.3f} | {:.2f} % |\n", name, part_s / trials * 1e3, 100.0 * part_s / sum_s);
  fmt::print("\nThe SE table, 101 points x 201 heights: {:.2f} ms, once per trial, if an agent has foresight.\n",
             parts.table_s / trials * 1e3);
  return 0;
}
