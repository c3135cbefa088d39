// "aloft coordinator" and "aloft metrics" each start one service of a run over several machines.
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "common/base/error.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "services/runtime/plugin_flag.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/supervise/processes.hpp"

namespace aloft::cli {
namespace {

struct StandaloneOptions {
  ExperimentOptions experiment;
  std::filesystem::path out;
  bus::BusOptions bus;
  std::vector<std::string> more;  // further arguments of the service

  void add_to(CLI::App& command) {
    command.add_option("--run", bus.run, "Name of the run, the same for all its processes")
        ->required()
        ->check(runtime::bus_name());
    runtime::add_bus_flags(command, bus);
  }
};

/// A file in memory, read by the service that replaces this process: the resolved experiment is checked here, and no
/// temporary file is left behind.
std::string unnamed_file(const std::string& content) {
  const int descriptor = memfd_create("experiment", 0);
  if (descriptor < 0 || write(descriptor, content.data(), content.size()) != static_cast<ssize_t>(content.size()))
    throw std::system_error(errno, std::generic_category(), "cannot hand over the experiment");
  return fmt::format("/proc/self/fd/{}", descriptor);
}

/// Replaces this process with the service, so that signals, exit code and service manager refer to it.
[[noreturn]] void become(const std::string& program, const StandaloneOptions& options, const std::string& experiment) {
  std::vector<std::string> arguments{program,
                                     "--experiment",
                                     experiment,
                                     "--results",
                                     options.out.string(),
                                     "--log-dir",
                                     (options.out / "log").string(),
                                     "--verbose"};
  const std::vector<std::string> place = runtime::bus_arguments(options.bus);
  arguments.insert(arguments.end(), place.begin(), place.end());
  const std::vector<std::string> plugins = runtime::plugin_arguments();
  arguments.insert(arguments.end(), plugins.begin(), plugins.end());
  arguments.insert(arguments.end(), options.more.begin(), options.more.end());
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(program_path(program).c_str(), argv.data());
  throw std::system_error(errno, std::generic_category(), "cannot start " + program_path(program).string());
}

/// Adds an option that the service itself checks.
void pass_on(CLI::App& command, const std::shared_ptr<StandaloneOptions>& options, const std::string& flag,
             const std::string& help) {
  command.add_option_function<std::string>(
      flag,
      [options, flag](const std::string& value) {
        options->more.insert(options->more.end(), {flag, value});
      },
      help);
}

std::string resolved(const ExperimentOptions& options) {
  return unnamed_file(options.load().canonical.dump());
}

/// The experiment of the command line, or the stored one, which the command line cannot change.
std::string resolved_or_stored(const StandaloneOptions& options) {
  if (!options.experiment.file.empty()) return resolved(options.experiment);
  const std::filesystem::path stored = options.out / "experiment.json";
  if (!std::filesystem::exists(stored))
    throw InputError("--out {}: holds no experiment.json; name the experiment file too", options.out.string());
  return stored.string();
}

}  // namespace

void add_coordinator(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "coordinator", "Hand out the trials of an experiment to workers on any machine, until every flight is stored");
  auto options = std::make_shared<StandaloneOptions>();
  options->experiment.add_to(*command);
  options->add_to(*command);
  command->add_option("--out", options->out, "Result folder of the run's metrics service, on the same machine")
      ->required();
  pass_on(*command, options, "--fail-fast", "Stop after this many failed trials; 0: fly the rest, then report [0]");
  pass_on(*command, options, "--give-up-after", "Time in seconds without any worker that ends the run; 0: never [0]");
  command->callback([options, &job] {
    job = [options]() -> int { become("aloft-coordinator", *options, resolved(options->experiment)); };
  });
}

void add_metrics(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("metrics", "Store the flights of a run that workers on any machine fly; one per run");
  auto options = std::make_shared<StandaloneOptions>();
  options->experiment.add_to(*command).required(false);
  options->add_to(*command);
  command->add_option("--out", options->out, "Result folder, made or continued")->required();
  options->more = {"--summary"};
  pass_on(*command, options, "--http-port", "Serve /healthz, /status and /metrics there; 0: any free port [none]");
  pass_on(*command, options, "--http-address", "Address for --http-port [127.0.0.1]");
  pass_on(*command, options, "--http-host",
          "Further names, separated by commas, under which HTTP requests may come; localhost and addresses may [none]");
  command->callback([options, &job] {
    job = [options]() -> int { become("aloft-metrics", *options, resolved_or_stored(*options)); };
  });
}

}  // namespace aloft::cli
