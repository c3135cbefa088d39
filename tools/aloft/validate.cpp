#include <fmt/format.h>
#include <unistd.h>

#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"
#include "common/experiment/warnings.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/in_process.hpp"

namespace aloft::cli {
namespace {

/// The parameters as JSON with spaces, at which lines can be broken.
std::string parameters_text(const agents::AgentSpec& agent) {
  std::string text;
  const nlohmann::json parameters = agent.parameters.to_json();
  for (const auto& [name, value] : parameters.items())
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name, value.dump());
  return "{" + text + "}";
}

void print_summary(const experiment::Experiment& experiment) {
  const auto print_item = [width = text_width(STDOUT_FILENO)](const std::string& indent, const std::string& text) {
    fmt::print("{}", wrapped(text, width, indent, indent + "    "));
  };
  fmt::print("{}: valid, experiment id {}\n", experiment.name, experiment.id);
  fmt::print("{} conditions x {} trials x {} agents = {} flights, seed {}\n", experiment.conditions.size(),
             experiment.trials, experiment.agents.size(),
             experiment.conditions.size() * experiment.trials * experiment.agents.size(), experiment.seed);
  for (const auto& condition : experiment.conditions)
    print_item("  ", fmt::format("condition {}: {}", condition.index, condition.name));
  for (const auto& agent : experiment.agents) {
    print_item("  ", fmt::format("agent {} {}", agent.name, parameters_text(agent)));
    for (const auto& member : agent.crew)
      print_item(
          "    ",
          fmt::format("{}: {}{} {}", member.from_step > 0 ? fmt::format("from step {}", member.from_step) : "stands by",
                      member.agent.name, member.shadow ? "" : " (comes aboard cold)", parameters_text(member.agent)));
  }
  for (const auto& warning : experiment::warnings(experiment)) print_item("  ", "warning: " + warning.text);
}

}  // namespace

void add_validate(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("validate", "Check an experiment file and show what it would run; nothing is written");
  auto options = std::make_shared<ExperimentOptions>();
  auto in_process = std::make_shared<bool>(false);
  auto format = std::make_shared<std::string>();
  options->add_to(*command);
  command->add_flag("--in-process", *in_process, "Whether 'aloft run --in-process' can fly it, too");
  add_format(*command, *format, {"text", "json"});
  command->callback([options, in_process, format, &job] {
    job = [options, in_process, format] {
      const experiment::Experiment experiment = options->load();
      if (*in_process) check_flies_in_process(experiment);
      if (*format == "json") {
        nlohmann::json warnings = nlohmann::json::array();
        for (const auto& warning : experiment::warnings(experiment)) warnings.push_back(warning.text);
        fmt::print("{}\n", nlohmann::json{{"experiment_id", experiment.id},
                                          {"resolved", experiment.canonical},
                                          {"warnings", std::move(warnings)}}
                               .dump(2));
      } else {
        print_summary(experiment);
      }
      return 0;
    };
  });
}

}  // namespace aloft::cli
