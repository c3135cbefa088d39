#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/experiment/summary.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/table_options.hpp"
#include "tools/compare/comparison.hpp"

namespace aloft::cli {
namespace {

using Json = nlohmann::ordered_json;
using compare::AgentComparison;
using compare::Comparison;

constexpr std::size_t settings_shown = 10;

/// Two open result folders and their comparison.
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
    // Encoded steps are compared, so that every field counts and NaN equals NaN.
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

void print_heading(const Both& both, std::size_t width) {
  const auto print_line = [&](const std::string& text) { fmt::print("{}", wrapped(text, width, "", "    ")); };
  const auto side = [&](char letter, const std::filesystem::path& dir, const experiment::Experiment& experiment) {
    print_line(fmt::format("{}: {}: experiment {} ({}), seed {}", letter, dir.string(), experiment.name, experiment.id,
                           experiment.seed));
  };
  side('A', both.dir_a, both.a.experiment());
  side('B', both.dir_b, both.b.experiment());
  if (both.comparison.same_experiment) {
    print_line("The same experiment.");
  } else {
    print_line("Different experiments; compared is what both have. Settings that differ:");
    for (const auto& setting : both.settings)
      fmt::print("{}",
                 wrapped(fmt::format("{}: A {}, B {}", setting.path, setting.a, setting.b), width, "  ", "      "));
    if (both.settings.size() == settings_shown) fmt::print("  ... and perhaps more\n");
  }
  print_line(both.comparison.paired
                 ? "Differences are B - A on the same trials."
                 : "Not paired: the seeds differ, so the worlds differ. Differences are mean of B - mean of A.");
}

std::vector<TextTable::Cell> table_row(const AgentComparison& row) {
  const double unit = row.kind == experiment::WorldKind::measured ? 1000.0 : 1.0;
  const auto& ci95 = row.difference_ci95;
  return {agents::marked(row.agent, agents::privilege_tier(row.privilege)),
          row.paired ? std::to_string(row.flights_a) : fmt::format("{} / {}", row.flights_a, row.flights_b),
          std::to_string(row.identical),
          fmt::format("{:.3f}", row.qos_mean_a / unit),
          fmt::format("{:.3f}", row.qos_mean_b / unit),
          fmt::format("{:+.3f}", row.difference / unit),
          ci95 ? fmt::format("[{:+.3f}, {:+.3f}]", ci95->low / unit, ci95->high / unit) : "-"};
}

/// A table per condition, all with the same columns.
void print_tables(const Comparison& comparison, const TableShape& shape) {
  std::vector<std::pair<std::string, TextTable>> tables;
  unsigned rank = TextTable::every_rank;
  for (const AgentComparison& row : comparison.agents) {
    const bool measured = row.kind == experiment::WorldKind::measured;
    const std::string heading = fmt::format("{}, {}", row.condition, measured ? "Mbit/s" : "bit/s/Hz");
    if (tables.empty() || tables.back().first != heading)
      tables.emplace_back(
          heading,
          TextTable({{"agent"}, {"flights", 3}, {"identical", 4}, {"A", 1}, {"B", 2}, {"B - A"}, {"95 % interval"}}));
    tables.back().second.add(table_row(row));
  }
  for (const auto& [heading, table] : tables) rank = std::min(rank, table.fitting_rank(shape));
  for (const auto& [heading, table] : tables)
    fmt::print("\n{}{}", wrapped(heading, shape.width), table.text(shape, rank));
  if (!tables.empty()) fmt::print("\n{}", tables.front().second.left_out(rank, shape));
}

void print_text(const Both& both, const TableShape& shape) {
  const Comparison& comparison = both.comparison;
  const auto print_line = [&](const std::string& text) { fmt::print("{}", wrapped(text, shape.width)); };
  print_heading(both, shape.width);
  print_tables(comparison, shape);
  if (std::ranges::any_of(comparison.agents,
                          [](const AgentComparison& row) { return row.privilege != agents::Privilege::none; }))
    print_line(fmt::format("Privileged: {}.", agents::marks_explained()));
  std::string counts =
      fmt::format("{} of {} flights that both have are identical", comparison.identical, comparison.in_both);
  if (comparison.only_a + comparison.only_b > 0)
    counts += fmt::format("; {} flights are in A alone, {} in B alone", comparison.only_a, comparison.only_b);
  print_line(counts + ".");
  if (comparison.first_different)
    print_line(fmt::format("First difference: {}.", describe(both, *comparison.first_different)));
}

}  // namespace

void add_compare(CLI::App& app, Job& job) {
  struct Options {
    std::filesystem::path dir_a;
    std::filesystem::path dir_b;
    bool exact = false;
    std::string format;
    TableOptions table;
  };
  auto* command = app.add_subcommand(
      "compare", "Compare two result folders: differences per condition and agent, identical flights");
  auto options = std::make_shared<Options>();
  command->add_option("dir_a", options->dir_a, "Result folder A")->required();
  command->add_option("dir_b", options->dir_b, "Result folder B")->required();
  command->add_flag("--exact", options->exact, "Exit code 1 unless both hold the same flights, byte for byte");
  add_format(*command, options->format, {"text", "json"});
  options->table.add_to(*command);
  command->callback([options, &job] {
    job = [options] {
      const Both both{options->dir_a, options->dir_b};
      options->format == "json" ? print_json(both) : print_text(both, options->table.shape());
      return options->exact && !both.comparison.all_identical() ? exit_failure : exit_ok;
    };
  });
}

}  // namespace aloft::cli
