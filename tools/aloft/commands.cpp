#include "tools/aloft/commands.hpp"

#include "common/experiment/experiment.hpp"

namespace aloft::cli {

namespace {

/// CLI11 would read "-1" as the largest unsigned number.
const CLI::Validator whole_number(
    [](const std::string& text) {
      return text.empty() || text.find_first_not_of("0123456789") != std::string::npos
                 ? "'" + text + "' is not allowed; use a whole number from 0"
                 : std::string();
    },
    "WHOLE NUMBER");

}  // namespace

CLI::Option& ExperimentOptions::add_to(CLI::App& command) {
  CLI::Option* option = command.add_option("experiment", file, "Experiment file (JSON); data/experiments/ has some");
  option->required();
  command
      .add_option("--set", overrides.set,
                  "Override one value: json.path=value, e.g. world.bs_density_per_km2=5; repeatable")
      ->expected(1)
      ->take_all();
  command.add_option("--agents", overrides.agents, "Agents instead of the file's, e.g. min-height,constant-120")
      ->delimiter(',');
  command.add_option("--trials", overrides.trials, "Trials per condition instead of the file's")->check(whole_number);
  command.add_option("--seed", overrides.seed, "Seed instead of the file's")->check(whole_number);
  return *option;
}

void add_format(CLI::App& command, std::string& format, std::vector<std::string> choices) {
  format = choices.front();
  command.add_option("--format", format, "Output format")
      ->check(CLI::IsMember(std::move(choices)))
      ->capture_default_str();
}

}  // namespace aloft::cli
