#include "tools/aloft/help.hpp"

#include <fmt/format.h>

#include <iterator>
#include <sstream>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"

namespace aloft::cli {
namespace {

/// The command that the words name, and the words before its name.
struct Found {
  const CLI::App* command;
  std::string path;
};

Found find_command(const CLI::App& app, const std::vector<std::string>& words) {
  Found found{&app, ""};
  for (const std::string& word : words) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : found.command->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
      if (command->get_name() == word) next = command;
    }
    found.path += (found.path.empty() ? "" : " ") + found.command->get_name();
    if (next == nullptr)
      throw InputError("'{}' has no command '{}'.{} 'aloft help' lists them", found.path, word,
                       did_you_mean(word, names));
    found.command = next;
  }
  return found;
}

/// A command line, and in some words what it is good for.
struct Example {
  const char* what;
  const char* command;
};

struct CommandExamples {
  const char* command;  ///< as in "aloft keys init"; empty: aloft itself
  std::vector<Example> examples;
};

const CommandExamples all_examples[] = {
    {"",
     {{"a first look: ten agents, a minute on two cores", "aloft run quick"},
      {"all about one command", "aloft help run"}}},
    {"run",
     {{"a first look: ten agents, a minute on two cores", "aloft run quick"},
      {"the paper's sweep; after Ctrl-C the same goes on", "aloft run bs-density --workers 2"},
      {"another setting goes into another folder",
       "aloft run bs-density --set world.los_ray=geometric --out results/ray"},
      {"your own measured flight, without DDS", "aloft run measured --set world.file=mine.csv --in-process"}}},
    {"validate",
     {{"an experiment of the package", "aloft validate quick"},
      {"with one value changed", "aloft validate bs-density --set world.steps=200"},
      {"every default filled in, for programs", "aloft validate quick --format json"}}},
    {"tournament",
     {{"all agents, half an hour of one core", "aloft tournament"},
      {"also over a measured flight, with a picture", "aloft tournament --data gcq.csv --picture tournament.svg"},
      {"a minute, without agents that train", "aloft tournament --agents min-height,height-filter,planner"}}},
    {"reproduce",
     {{"all that needs no data, 9 minutes of CPU time", "aloft reproduce"},
      {"one figure, fewer trials", "aloft reproduce --figure bs-density --trials 30"},
      {"with the measured flight", "aloft reproduce --data gcq=gcq.csv"}}},
    {"report",
     {{"results/quick/report.html", "aloft report results/quick"},
      {"also every chart, for a paper", "aloft report results/quick --svg charts"},
      {"also its tables, and the page as PDF", "aloft report results/quick --latex tables.tex --pdf report.pdf"}}},
    {"live",
     {{"what flew, step by step", "aloft live results/quick"},
      {"at an address that stays the same", "aloft live results/quick --http-port 8080"},
      {"how a run goes, and its flights", "aloft live --run lab"}}},
    {"compare",
     {{"what a setting changed", "aloft compare results/before results/after"},
      {"are they the same, byte for byte?", "aloft compare results/a results/b --exact"}}},
    {"export",
     {{"one row per flight", "aloft export results/quick --flights"},
      {"every step of every flight", "aloft export results/quick --steps --format json"},
      {"a recording to watch in Foxglove", "aloft export results/quick --format mcap --trial 0 --out quick.mcap"},
      {"curves for TensorBoard", "aloft export results/quick --format tensorboard --out quick-events"}}},
    {"digest", {{"the same digest: the same flights, byte for byte", "aloft digest results/quick"}}},
    {"agents",
     {{"who can fly", "aloft agents --brief"},
      {"one with all its parameters", "aloft agents dqn"},
      {"does it keep what every agent promises?", "aloft agents --check random-walk"},
      {"for programs", "aloft agents --format json"}}},
    {"inspect world", {{"the city of one trial", "aloft inspect world quick --condition 2 --trial 3"}}},
    {"inspect table",
     {{"all qualities of one trial", "aloft inspect table quick --condition 0 --trial 3 --format csv"},
      {"how the value at step 40 and 120 m came about", "aloft inspect table quick --explain 40,120"}}},
    {"inspect link",
     {{"3GPP's urban macro cell, 1 km away", "aloft inspect link --model uma-av --height 60 --distance 1000"}}},
    {"status",
     {{"all runs in DDS domain 0 of this machine", "aloft status"},
      {"one run, until Ctrl-C", "aloft status --run lab --watch"},
      {"for programs", "aloft status --format json"}}},
    {"doctor",
     {{"before the first run, or when a run does not start", "aloft doctor"},
      {"remove what killed programs left", "aloft doctor --clean"},
      {"as the run will be", "aloft doctor --domain 7 --interface lo --out results"}}},
    {"coordinator",
     {{"beside the run's metrics service",
       "aloft coordinator bs-density --run lab --out results/lab --interface eth0"}}},
    {"metrics",
     {{"with a page for monitoring on port 8080",
       "aloft metrics bs-density --run lab --out results/lab --http-port 8080"}}},
    {"worker",
     {{"help a run on another host", "aloft worker --join lab --interface eth0"},
      {"fly only the learner", "aloft worker --join lab --agents dqn --learner-threads 4"}}},
    {"swap",
     {{"dqn takes over at once", "aloft swap --run lab --worker w0 --agent dqn"},
      {"in every flight from step 51 on", "aloft swap --run lab --worker w0 --agent dqn --at-step 51"}}},
    {"keys init", {{"an authority for ten years", "aloft keys init keys"}}},
    {"keys issue",
     {{"for a run on one machine", "aloft keys issue keys all"},
      {"for the workers of another host", "aloft keys issue keys environment channel --name host7 --out keys-host7"}}},
    {"import-rdata", {{"the flight over Grand Canal Quay", "aloft import-rdata Real_canal_tudo1.Rdata --out gcq.csv"}}},
    {"import-scatter",
     {{"the SINR of the serving cell, wherever it was measured",
       "aloft import-scatter data/samples/scatter_sample.csv --altitude altitude_m --sinr sinr_db --cell cell --time "
       "time --ground 4 --out grid.csv"},
      {"the RSRP of all cells, along a route of your own",
       "aloft import-scatter scan.csv --rsrp rsrp --cell pci --route 53.340,-6.240 53.345,-6.230 --out grid.csv"}}},
    {"import-map",
     {{"the sample that comes with Aloft",
       "aloft import-map data/samples/map_sample.npz --route 20,20 380,20 380,180 --out grid.csv"}}},
    {"train pretrained",
     {{"the model that comes with Aloft, anew",
       "aloft train pretrained --config data/models/pretrained.json --out mine.pb"}}},
    {"completions",
     {{"in every bash of yours, if Aloft is not installed",
       "aloft completions bash > ~/.local/share/bash-completion/completions/aloft"}}},
    {"help", {{"what there is", "aloft help"}, {"all about one command", "aloft help run"}}},
};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

}  // namespace

void add_examples(CLI::App& app) {
  for (const CommandExamples& entry : all_examples) {
    CLI::App* command = &app;
    for (const std::string& word : words_of(entry.command)) command = command->get_subcommand(word);
    std::string text = entry.examples.size() == 1 ? "Example:" : "Examples:";
    for (const Example& example : entry.examples) text += fmt::format("\n  # {}\n  {}", example.what, example.command);
    command->footer(text);
  }
}

void add_help(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("help", "List the commands, or tell all about one");
  auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("command", *words, "The command, e.g. run, or keys issue");
  command->callback([&app, words, &job] {
    job = [&app, words] {
      const Found found = find_command(app, *words);
      const std::string name = found.path + (found.path.empty() ? "" : " ") + found.command->get_name();
      fmt::print("{}", app.get_formatter()->make_help(found.command, name, CLI::AppFormatMode::Normal));
      return exit_ok;
    };
  });
}

}  // namespace aloft::cli
