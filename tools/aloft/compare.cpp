#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/experiment/summary.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/compare/comparison.hpp"

namespace aloft::cli {
namespace {

using Json = nlohmann::ordered_json;
using compare::AgentComparison;
using compare::Comparison;

constexpr std::size_t settings_shown = 10;

/// Two open result folders and what comes of comparing them.
struct Both {
  std::filesystem::path dir_a;
  std::filesystem::path dir_b;
  store::ResultStore a = store::ResultStore::open_for_reading(dir_a);
  store::ResultStore b = store::ResultStore::open_for_reading(dir_b);
  Comparison comparison = compare::compare({a.experiment(), a.flights()}, {b.experiment(), b.flights()});
  std::vector<compare::SettingDifference> settings =
      compare::setting_differences(a.experiment(), b.experiment(), settings_shown);
};

/// The first step whose records differ; both flights have at least one.
std::uint32_t first_different_step(const flight::FlightRecord& a, const flight::FlightRecord& b) {
  const std::size_t common = std::min(a.steps.size(), b.steps.size());
  for (std::size_t i = 0; i < common; ++i) {
    // One step by itself, encoded: whatever field differs, and NaN equals NaN.
    const auto alone = [i](const flight::FlightRecord& record) {
      flight::FlightRecord one = record;
      one.steps = {record.steps[i]};
      return store::encode_trace(one);
    };
    if (alone(a) != alone(b)) return a.steps[i].step;
  }
  return static_cast<std::uint32_t>(common);
}

std::string describe(const Both& both, const compare::DifferentFlight& different) {
  const auto record_a = store::decode_trace(both.a.trace(different.a));
  const auto record_b = store::decode_trace(both.b.trace(different.b));
  return fmt::format("condition {}, trial {}, agent {}: from step {} on",
                     both.a.experiment().conditions.at(different.a.condition).name, different.a.trial,
                     different.a.agent, first_different_step(record_a, record_b));
}

Json row_json(const AgentComparison& row) {
  return {{"condition", row.condition},
          {"agent", row.agent},
          {"privilege", agents::privilege_tier(row.privilege).name},
          {"qos_unit", experiment::qos_unit(row.kind)},
          {"paired", row.paired},
          {"flights_a", row.flights_a},
          {"flights_b", row.flights_b},
          {"flights_in_both", row.in_both},
          {"flights_identical", row.identical},
          {"qos_mean_a", row.qos_mean_a},
          {"qos_mean_b", row.qos_mean_b},
          {"qos_difference", row.difference},
          {"qos_difference_ci95",
           row.difference_ci95 ? Json{row.difference_ci95->low, row.difference_ci95->high} : Json()}};
}

void print_json(const Both& both) {
  const Comparison& comparison = both.comparison;
  Json document{
      {"a", {{"dir", both.dir_a.string()}, {"experiment_id", both.a.experiment().id}}},
      {"b", {{"dir", both.dir_b.string()}, {"experiment_id", both.b.experiment().id}}},
      {"same_experiment", comparison.same_experiment},
      {"paired", comparison.paired},
      {"identical", comparison.all_identical()},
      {"flights_in_both", comparison.in_both},
      {"flights_identical", comparison.identical},
      {"flights_only_in_a", comparison.only_a},
      {"flights_only_in_b", comparison.only_b},
      {"first_difference", comparison.first_different ? Json(describe(both, *comparison.first_different)) : Json()},
      {"settings", Json::array()},
      {"agents", Json::array()}};
  for (const auto& setting : both.settings)
    document["settings"].push_back({{"path", setting.path}, {"a", setting.a}, {"b", setting.b}});
  for (const AgentComparison& row : comparison.agents) document["agents"].push_back(row_json(row));
  fmt::print("{}\n", document.dump(2));
}

void print_heading(const Both& both) {
  const auto side = [](char letter, const std::filesystem::path& dir, const experiment::Experiment& experiment) {
    fmt::print("{}: {}: experiment {} ({}), seed {}\n", letter, dir.string(), experiment.name, experiment.id,
               experiment.seed);
  };
  side('A', both.dir_a, both.a.experiment());
  side('B', both.dir_b, both.b.experiment());
  if (both.comparison.same_experiment) {
    fmt::print("The same experiment.\n");
  } else {
    fmt::print("Different experiments; compared is what both have. Settings that differ:\n");
    for (const auto& setting : both.settings) fmt::print("  {}: A {}, B {}\n", setting.path, setting.a, setting.b);
    if (both.settings.size() == settings_shown) fmt::print("  ... and perhaps more\n");
  }
  fmt::print("{}\n\n",
             both.comparison.paired
                 ? "Differences are B - A on the same trials."
                 : "Not paired: the seeds differ, so the worlds differ. Differences are mean of B - mean of A.");
}

void print_table(const Comparison& comparison) {
  std::size_t condition_width = 9;
  std::size_t agent_width = 5;
  const auto agent = [](const AgentComparison& row) {
    return agents::marked(row.agent, agents::privilege_tier(row.privilege));
  };
  for (const AgentComparison& row : comparison.agents) {
    condition_width = std::max(condition_width, row.condition.size());
    agent_width = std::max(agent_width, agent(row).size());
  }
  fmt::print("{:<{}}  {:<{}}  {:>11}  {:>9}  {:>10}  {:>10}  {:>10}  {:<22}  unit\n", "condition", condition_width,
             "agent", agent_width, "flights", "identical", "A", "B", "B - A", "95 % interval");
  for (const AgentComparison& row : comparison.agents) {
    const bool measured = row.kind == experiment::WorldKind::measured;
    const double unit = measured ? 1000.0 : 1.0;
    const std::string interval =
        row.difference_ci95
            ? fmt::format("[{:+.3f}, {:+.3f}]", row.difference_ci95->low / unit, row.difference_ci95->high / unit)
            : "-";
    const std::string flights =
        row.paired ? std::to_string(row.flights_a) : fmt::format("{} / {}", row.flights_a, row.flights_b);
    fmt::print("{:<{}}  {:<{}}  {:>11}  {:>9}  {:>10.3f}  {:>10.3f}  {:>+10.3f}  {:<22}  {}\n", row.condition,
               condition_width, agent(row), agent_width, flights, row.identical, row.qos_mean_a / unit,
               row.qos_mean_b / unit, row.difference / unit, interval, measured ? "Mbit/s" : "bit/s/Hz");
  }
}

void print_text(const Both& both) {
  const Comparison& comparison = both.comparison;
  print_heading(both);
  print_table(comparison);
  if (std::any_of(comparison.agents.begin(), comparison.agents.end(),
                  [](const AgentComparison& row) { return row.privilege != agents::Privilege::none; }))
    fmt::print("Privileged: {}.\n", agents::marks_explained());
  fmt::print("\n{} of {} flights that both have are identical", comparison.identical, comparison.in_both);
  if (comparison.only_a + comparison.only_b > 0)
    fmt::print("; {} flights are in A alone, {} in B alone", comparison.only_a, comparison.only_b);
  fmt::print(".\n");
  if (comparison.first_different) fmt::print("First difference: {}.\n", describe(both, *comparison.first_different));
}

}  // namespace

void add_compare(CLI::App& app, Job& job) {
  struct Options {
    std::filesystem::path dir_a;
    std::filesystem::path dir_b;
    bool exact = false;
    std::string format;
  };
  auto* command = app.add_subcommand(
      "compare", "Compare two result folders: differences per condition and agent, identical flights");
  auto options = std::make_shared<Options>();
  command->add_option("dir_a", options->dir_a, "Result folder A")->required();
  command->add_option("dir_b", options->dir_b, "Result folder B")->required();
  command->add_flag("--exact", options->exact, "Exit code 1 unless both hold the same flights, byte for byte");
  add_format(*command, options->format, {"text", "json"});
  command->callback([options, &job] {
    job = [options] {
      const Both both{options->dir_a, options->dir_b};
      options->format == "json" ? print_json(both) : print_text(both);
      return options->exact && !both.comparison.all_identical() ? exit_failure : exit_ok;
    };
  });
}

}  // namespace aloft::cli
