#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/terminal.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/measured_files.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/package_data.hpp"
#include "tools/aloft/supervise/local_experiment.hpp"
#include "tools/aloft/table_options.hpp"
#include "tools/report/report.hpp"
#include "tools/report/tournament_table.hpp"

namespace aloft::cli {
namespace {

struct TournamentOptions {
  ExperimentOptions experiment;
  std::vector<std::string> data;
  std::filesystem::path out = "results/tournament";
  std::filesystem::path picture;
  std::uint32_t dqn_trials = 60;
  FlyingOptions flying;
  std::string format;
  TableOptions table;
};

using Json = nlohmann::json;

bool needs_sites(const Json& agent) {
  const agents::AgentSpec spec = agents::parse_agents(agent, "agents").front();
  const auto has_map = [](const agents::AgentSpec& one) { return one.privilege() == agents::Privilege::site_map; };
  return has_map(spec) || std::ranges::any_of(spec.crew, [&](const auto& member) { return has_map(member.agent); });
}

/// The agents of `cities` over one measured flight, named after its file. Agents with the site map only where there is
/// one.
Json over_measured(const Json& cities, const std::string& file) {
  Json document = cities;
  const std::string name = std::filesystem::path(file).stem().string();
  document["name"] = fmt::format("{}-{}", cities.at("name").get<std::string>(), name);
  if (!experiment::has_sites(file)) std::erase_if(document["agents"].get_ref<Json::array_t&>(), needs_sites);
  document["worlds"] = Json::array({{{"kind", "measured"}, {"name", name}, {"file", file}}});
  return document;
}

bool trains_in_flight(const Json& agent) {
  return agent.at("type") == "dqn";
}

/// Two experiments over the same worlds. Agents that train in flight cost a thousand times as much as all others
/// together, so they fly only the first trials, with the two agents that gains and head-room refer to.
std::vector<experiment::Experiment> split(const Json& whole, std::uint32_t dqn_trials) {
  Json cheap = whole;
  Json costly = whole;
  costly["name"] = whole.at("name").get<std::string>() + "-dqn";
  costly["trials"] = std::min(dqn_trials, whole.at("trials").get<std::uint32_t>());
  cheap["agents"] = Json::array();
  costly["agents"] = Json::array();
  bool any_costly = false;
  for (const Json& agent : whole.at("agents")) {
    const bool reference = agent.at("type") == "min-height" || agent.at("type") == "planner";
    any_costly = any_costly || trains_in_flight(agent);
    if (!trains_in_flight(agent)) cheap["agents"].push_back(agent);
    if (reference || trains_in_flight(agent)) costly["agents"].push_back(agent);
  }
  std::vector<experiment::Experiment> parts;
  for (const Json& part : {cheap, costly})
    if (!part.at("agents").empty() && (part != costly || any_costly))
      parts.push_back(experiment::parse(part.dump(), part.at("name").get<std::string>()));
  return parts;
}

/// Resolves, and so checks, all experiments before the first is flown.
std::vector<experiment::Experiment> experiments(const TournamentOptions& options) {
  ExperimentOptions chosen = options.experiment;
  if (chosen.file.empty()) chosen.file = find_experiment("tournament");
  const Json cities = chosen.load().canonical;
  std::vector<experiment::Experiment> all = split(cities, options.dqn_trials);
  for (const std::string& file : options.data)
    for (experiment::Experiment& part : split(over_measured(cities, file), options.dqn_trials))
      all.push_back(std::move(part));
  return all;
}

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// CPU time per step of every agent on the first condition: everything but the radio, which is computed beforehand.
void measure_step_costs(const experiment::Experiment& experiment, report::StepCosts& costs) {
  constexpr double enough_s = 0.2;
  constexpr std::uint32_t most_flights = 1'000;
  const auto map = experiment::make_signal_map(experiment, experiment.conditions.front(), 0);
  map->prepare();
  for (const agents::AgentSpec& spec : experiment.agents) {
    if (agents::agent_type(spec.type).foreign || costs.contains(spec.name)) continue;
    (void)spec.make();  // a model file is read once per process, which must not count
    std::uint64_t steps = 0;
    const double started_s = thread_cpu_s();
    double spent_s = 0.0;
    for (std::uint32_t flight = 0; flight < most_flights && spent_s < enough_s; ++flight) {
      const auto agent = spec.make();
      steps +=
          flight::fly(*map, experiment.seed, flight, *agent, spec, experiment.costs_in(experiment.conditions.front()))
              .steps.size();
      spent_s = thread_cpu_s() - started_s;
    }
    costs[spec.name] = 1e6 * spent_s / static_cast<double>(steps);
  }
}

void save_picture(const TournamentOptions& options, const std::string& experiment) {
  const std::filesystem::path chart = options.out / "charts" / (experiment + "-gains.svg");
  if (!std::filesystem::exists(chart))
    throw InputError("--picture: '{}' has fewer than two generated conditions, so there is no such chart", experiment);
  write_file(options.picture, read_file(chart));
}

int tournament(const TournamentOptions& options) {
  report::require_charts();
  const std::vector<experiment::Experiment> all = experiments(options);
  if (const int exit_code = fly_experiments(all, options.out, options.flying); exit_code != exit_ok) return exit_code;

  std::vector<report::ConditionTrials> conditions;
  for (const experiment::Experiment& experiment : all)
    for (report::ConditionTrials& condition :
         report::read_trials(store::ResultStore::open_for_reading(options.out / experiment.name)))
      conditions.push_back(std::move(condition));
  report::StepCosts costs;
  for (const experiment::Experiment& experiment : all) measure_step_costs(experiment, costs);
  const TextTable overview = report::tournament_overview(conditions, costs);
  const std::filesystem::path tables = options.out / "tournament.md";
  const std::string legend = fmt::format(
      "Gain over min-height on the same {} trials (seed {}); columns: base stations / buildings per "
      "km², bit/s/Hz; measured flights in Mbit/s. ± is half a 95 % interval; there is none where all trials gave "
      "the same, or with one trial. {}.",
      all.front().trials, all.front().seed, agents::marks_explained());
  write_file(tables, fmt::format("{}\n\n{}\n{}", legend, overview.markdown(), report::tournament_details(conditions)));
  report::ReportOptions report;
  if (!options.picture.empty()) report.svg = options.out / "charts";
  const report::WrittenReport written = report::write_report(options.out, report);
  if (!options.picture.empty()) save_picture(options, all.front().name);
  const TableShape shape = options.table.shape();
  if (options.format == "markdown" || (options.format.empty() && isatty(STDOUT_FILENO) == 0))
    fmt::print("{}", overview.markdown());
  else
    fmt::print("{}\n{}", wrapped(legend, shape.width), overview.text(shape, shape.brief ? 0 : TextTable::every_rank));
  std::fflush(stdout);
  fmt::print(stderr, "{}",
             wrapped(fmt::format("Tables: {}; report: {}", tables.string(), written.page.string()),
                     text_width(STDERR_FILENO)));
  return exit_ok;
}

}  // namespace

void add_tournament(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "tournament", "Fly all agents against each other; tables of gains over min-height, costs, and a report");
  auto options = std::make_shared<TournamentOptions>();
  options->experiment.add_to(*command);
  command->get_option("experiment")->required(false)->default_str("tournament");
  command->add_option("--data", options->data, "A measured flight (CSV) that all agents fly as well; repeatable")
      ->expected(1)
      ->take_all();
  command->add_option("--out", options->out, "Result folder; an interrupted run in it is resumed")
      ->capture_default_str();
  command->add_option("--picture", options->picture, "Also save the chart of all gains as this SVG file (needs Node)");
  command
      ->add_option("--dqn-trials", options->dqn_trials,
                   "Trials per condition that agents of type dqn fly, at most those of the experiment; a flight takes "
                   "about a second of CPU time")
      ->check(runtime::whole_number(1, 100'000))
      ->capture_default_str();
  command->add_option("--format", options->format, "Output format [text in a terminal, else markdown]")
      ->check(CLI::IsMember({"text", "markdown"}));
  options->table.add_to(*command);
  options->flying.add_to(*command);
  command->callback([options, &job] { job = [options] { return tournament(*options); }; });
}

}  // namespace aloft::cli
