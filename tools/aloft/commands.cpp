#include "tools/aloft/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/agents/registry.hpp"
#include "common/base/plain_text.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/package_data.hpp"

namespace aloft::cli {

CLI::Validator agent_name() {
  const auto check = [](const std::string& text) {
    return agents::is_agent_name(text)
               ? ""
               : fmt::format("'{}' is not allowed; use the name of an agent, as 'aloft agents' lists them",
                             excerpt(text));
  };
  return {check, "NAME"};
}

CLI::Option& ExperimentOptions::add_to(CLI::App& command) {
  CLI::Option* option = command.add_option("experiment", file,
                                           fmt::format("Experiment file (JSON), or the name of one that comes "
                                                       "with Aloft: {}. Relative paths in the file count from its "
                                                       "folder",
                                                       fmt::join(package_experiments(), ", ")));
  option->required();
  option->transform(CLI::Validator(
      [](std::string& given) {
        given = find_experiment(given).string();
        return std::string();
      },
      ""));
  command
      .add_option("--set", overrides.set,
                  "Override one value: json.path=value, e.g. world.bs_density_per_km2=5; repeatable. Relative paths "
                  "count from the working directory")
      ->expected(1)
      ->take_all();
  command.add_option("--agents", overrides.agents, "Agents instead of the file's, e.g. min-height,constant-120")
      ->delimiter(',')
      ->check(agent_name());
  command.add_option("--trials", overrides.trials, "Trials per condition instead of the file's")
      ->check(runtime::whole_number(1, 10'000'000));
  command.add_option("--seed", overrides.seed, "Seed instead of the file's")
      ->check(runtime::whole_number(0, UINT64_MAX));
  return *option;
}

}  // namespace aloft::cli
