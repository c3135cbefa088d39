#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/supervise/local_experiment.hpp"
#include "tools/aloft/table_options.hpp"
#include "tools/report/report.hpp"

namespace aloft::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ReproduceOptions {
  std::filesystem::path out = "results/reproduce";
  std::string figure = "all";
  std::vector<std::string> data;
  std::uint32_t trials = 100;
  FlyingOptions flying;
  TableOptions table;
};

Json generated_world(const Json& bs_density_per_km2, const Json& building_density_per_km2) {
  return {{"preset", "published"},
          {"bs_density_per_km2", bs_density_per_km2},
          {"building_density_per_km2", building_density_per_km2}};
}

/// The paper's experiments over generated cities, by figure. "all" flies the condition that both figures share once.
Json generated_worlds(const std::string& figure) {
  const Json bs_densities = {1, 2.5, 5};
  if (figure == "bs-density") return Json::array({generated_world(bs_densities, 200)});
  if (figure == "building-density") return Json::array({generated_world(2.5, {100, 200, 300})});
  return Json::array({generated_world(bs_densities, 200), generated_world(2.5, {100, 300})});
}

experiment::Experiment make_experiment(const std::string& name, std::uint32_t trials, const Json& worlds,
                                       const Json& constant_agents) {
  Json agents{"min-height"};
  agents.insert(agents.end(), constant_agents.begin(), constant_agents.end());
  for (const char* agent : {"random-walk", "one-step-ahead", "optimal-height", "planner", "dqn"})
    agents.push_back(agent);
  const Json file{{"name", name}, {"seed", 1}, {"trials", trials}, {"worlds", worlds}, {"agents", agents}};
  return experiment::parse(file.dump(), name);
}

/// Files of measured flights by name, from --data gcq=FILE.
std::map<std::string, std::string> measured_files(const std::vector<std::string>& data) {
  const std::vector<std::string> known{"gcq", "nwq"};
  std::map<std::string, std::string> files;
  for (const std::string& entry : data) {
    const std::size_t equals = entry.find('=');
    const std::string flight = entry.substr(0, equals);
    if (equals == std::string::npos || std::ranges::find(known, flight) == known.end())
      throw InputError("--data {}: not understood; use gcq=FILE or nwq=FILE.{}", entry, did_you_mean(flight, known));
    files[flight] = entry.substr(equals + 1);
  }
  return files;
}

/// Resolves, and so checks, all experiments before the first is flown.
std::vector<experiment::Experiment> experiments(const ReproduceOptions& options) {
  std::vector<experiment::Experiment> list;
  const auto files = measured_files(options.data);
  if (options.figure == "measured" && files.empty())
    throw InputError("--figure measured: no flight is given; use --data gcq=FILE, see 'aloft import-rdata --help'");
  if (options.figure != "measured")
    list.push_back(make_experiment(options.figure == "all" ? "cities" : options.figure, options.trials,
                                   generated_worlds(options.figure), {"constant-120", "constant-240"}));
  for (const auto& [flight, file] : files)
    list.push_back(make_experiment("measured-" + flight, options.trials,
                                   Json::array({{{"kind", "measured"}, {"name", flight}, {"file", file}}}),
                                   {"constant-60", "constant-120"}));
  return list;
}

int reproduce(const ReproduceOptions& options) {
  report::require_charts();
  const std::vector<experiment::Experiment> all = experiments(options);
  const int exit_code = fly_experiments(all, options.out, options.flying, [&](const std::filesystem::path& dir) {
    fmt::print("{}\n", comparison(dir, "text", options.table.shape()));
    std::fflush(stdout);
  });
  if (exit_code != exit_ok) return exit_code;
  const report::WrittenReport written = report::write_report(options.out);
  fmt::print(stderr, "Report, with the published values beside ours: {}\n", written.page.string());
  return exit_ok;
}

}  // namespace

void add_reproduce(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "reproduce", "Fly all experiments of the paper and write one report with the published values beside ours");
  auto options = std::make_shared<ReproduceOptions>();
  command->add_option("--out", options->out, "Result folder; an interrupted run in it is resumed")
      ->capture_default_str();
  command->add_option("--figure", options->figure, "Only one figure's experiments")
      ->check(CLI::IsMember({"all", "bs-density", "building-density", "measured"}))
      ->capture_default_str();
  command->add_option("--data", options->data, "A measured flight of the paper: gcq=FILE or nwq=FILE (CSV); repeatable")
      ->expected(1)
      ->take_all();
  command->add_option("--trials", options->trials, "Trials per condition; the paper has 100")
      ->check(runtime::whole_number(1, 100'000))
      ->capture_default_str();
  options->flying.add_to(*command);
  options->table.add_to(*command);
  command->callback([options, &job] { job = [options] { return reproduce(*options); }; });
}

}  // namespace aloft::cli
