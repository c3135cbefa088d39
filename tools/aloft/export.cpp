#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/find_condition.hpp"
#include "tools/export/recording.hpp"
#include "tools/export/rows.hpp"
#include "tools/export/tensorboard.hpp"

namespace aloft::cli {
namespace {

struct ExportOptions {
  std::filesystem::path dir;
  bool steps = false;
  bool flights = false;
  std::string format;
  std::filesystem::path out;
  std::string condition;
  std::optional<std::uint32_t> trial;
  std::vector<std::string> agents;

  /// Whether rows of text are asked for, and not a file of another program's.
  [[nodiscard]] bool rows() const { return format == "csv" || format == "json"; }
  [[nodiscard]] bool narrowed() const { return !condition.empty() || trial || !agents.empty(); }
};

void check(const ExportOptions& options) {
  if (options.rows()) {
    if (options.steps == options.flights)
      throw InputError("--format {} writes rows: add either --flights, one per flight, or --steps, one per step",
                       options.format);
    if (!options.out.empty())
      throw InputError("--out: the rows of --format {} go to standard output; redirect that to a file", options.format);
    return;
  }
  if (options.steps || options.flights)
    throw InputError("--flights and --steps are for --format csv and json; {} has all of a flight", options.format);
  if (options.out.empty())
    throw InputError("--format {} needs --out: the {} to write", options.format,
                     options.format == "mcap" ? "file" : "folder");
}

/// The stored flights of these conditions, trials and agents.
std::vector<store::FlightSummary> selected(const store::ResultStore& results, const ExportOptions& options) {
  std::optional<std::uint32_t> condition;
  if (!options.condition.empty()) condition = find_condition(results.experiment(), options.condition).index;
  for (const std::string& agent : options.agents) (void)results.experiment().agent(agent);  // InputError if unknown
  std::vector<store::FlightSummary> flights;
  results.for_each_flight([&](const store::FlightSummary& flight) {
    const experiment::FlightKey& key = flight.key;
    if ((!condition || key.condition == *condition) && (!options.trial || key.trial == *options.trial) &&
        (options.agents.empty() || std::ranges::find(options.agents, key.agent) != options.agents.end()))
      flights.push_back(flight);
  });
  if (flights.empty() && (options.narrowed() || !options.rows()))
    throw InputError("{}: there is no such flight; 'aloft export {} --flights' lists all", options.dir.string(),
                     options.dir.string());
  return flights;
}

/// Refuses Parquet with the reason, and says what to do instead.
CLI::Validator no_parquet() {
  return {[](const std::string& format) {
            return format != "parquet"
                       ? ""
                       : "Debian 12 and 13 have no library that writes Parquet (Apache Arrow). In Python: "
                         "aloft.read(\"DIR\").steps.to_polars().write_parquet(\"steps.parquet\"), "
                         "and flights likewise; docs/export.md tells more";
          },
          ""};
}

int export_training(const ExportOptions& options) {
  if (options.format != "tensorboard")
    throw InputError(
        "{}: a file; --format {} is of the result folders of 'aloft run'. Validation logs of 'aloft train' "
        "can be written with --format tensorboard",
        options.dir.string(), options.format);
  if (options.narrowed())
    throw InputError("--condition, --trial, --agents: the log of a training has none of them; leave them out");
  exports::write_training_events(options.dir, options.out);
  fmt::print("{}\n", options.out.string());
  return exit_ok;
}

int export_results(const ExportOptions& options) {
  check(options);
  if (std::filesystem::is_regular_file(options.dir)) return export_training(options);
  const auto results = store::ResultStore::open_for_reading(options.dir);
  const std::vector<store::FlightSummary> flights = selected(results, options);
  if (options.rows()) {
    exports::write_rows(results, flights, options.steps ? exports::Rows::steps : exports::Rows::flights,
                        options.format == "json" ? exports::RowFormat::json : exports::RowFormat::csv, stdout);
    return exit_ok;
  }
  options.format == "mcap" ? exports::write_recording(results, flights, options.out)
                           : exports::write_events(results, flights, options.out);
  fmt::print("{}\n", options.out.string());
  return exit_ok;
}

}  // namespace

void add_export(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("export", "Write the flights of a result folder as tables, or for Foxglove or TensorBoard");
  auto options = std::make_shared<ExportOptions>();
  command
      ->add_option("dir", options->dir,
                   "Result folder of 'aloft run'; for TensorBoard also a validation log of 'aloft train'")
      ->required();
  command->add_flag("--flights", options->flights, "One row per flight");
  command->add_flag("--steps", options->steps, "One row per step of every flight");
  add_format(*command, options->format, {"csv", "json", "mcap", "tensorboard"});
  command->get_option("--format")->transform(no_parquet());  // asked before the list of formats
  command->add_option("--out", options->out,
                      "The file (mcap) or new folder (tensorboard) to write; rows go to standard output");
  command->add_option("--condition", options->condition, "Only flights of this condition: its index or name");
  command->add_option("--trial", options->trial, "Only flights of this trial, from 0")
      ->check(runtime::whole_number(0, 9'999'999));
  command->add_option("--agents", options->agents, "Only flights of these agents, e.g. min-height,constant-120")
      ->delimiter(',')
      ->check(agent_name());
  command->callback([options, &job] { job = [options] { return export_results(*options); }; });
}

}  // namespace aloft::cli
