#include "services/runtime/service.hpp"

#include <signal.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <optional>
#include <system_error>
#include <vector>

#include "common/agents/load_plugin.hpp"
#include "common/base/error.hpp"
#include "common/base/follow_parent.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "services/runtime/help_format.hpp"
#include "services/runtime/plain_log.hpp"
#include "services/runtime/plugin_flag.hpp"
#include "services/runtime/standstill_watch.hpp"

namespace aloft::runtime {
namespace {

constexpr std::size_t log_file_bytes = 16U << 20U;
constexpr std::size_t log_files = 3;
constexpr std::string_view program_prefix = "aloft-";

struct CommonOptions {
  bus::BusOptions bus;
  std::filesystem::path log_dir;
  std::string log_level = "info";
  bool die_with_parent = false;
  bool verbose = false;
  std::vector<std::string> plugins;
};

void declare(CLI::App& app, CommonOptions& options, const ServiceInfo& info) {
  app.add_option("--run", options.bus.run, "Name of the run: only processes with the same one hear each other")
      ->check(bus_name())
      ->capture_default_str();
  add_bus_flags(app, options.bus);
  app.add_option("--log-dir", options.log_dir, "Folder for this process's log file; none: no log file");
  app.add_option("--log-level", options.log_level, "Least level that is logged")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error"}))
      ->capture_default_str();
  app.add_flag("--verbose", options.verbose, "Log to standard error what goes to the file, not only warnings");
  app.add_flag("--die-with-parent", options.die_with_parent, "End when the process that started this one ends");
  add_plugin_flag(app, options.plugins);
  if (info.in_worker)
    app.add_option("--worker", options.bus.worker, "Name of the worker that this process belongs to")
        ->required()
        ->check(bus_name());
}

/// Standard error alone, until the options are known.
void open_first_log(const std::string& name) {
  auto logger = std::make_shared<spdlog::logger>(name, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_formatter(plain_log("%n: %v"));
  spdlog::set_default_logger(std::move(logger));
}

/// The log folder, if this process had to make it. A process that is refused removes it again: its error is on standard
/// error.
class MadeLog {
 public:
  void make(const std::filesystem::path& file) {
    for (auto folder = file.parent_path(); !folder.empty() && !std::filesystem::exists(folder);
         folder = folder.parent_path())
      made_.push_back(folder);
    if (!made_.empty()) made_.insert(made_.begin(), file);
    std::filesystem::create_directories(file.parent_path());
  }
  void take_back() const {
    std::error_code ignored;  // a folder with something in it stays
    for (const std::filesystem::path& path : made_) std::filesystem::remove(path, ignored);
  }

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
};

/// The file takes everything from the chosen level on, standard error (without --verbose) only warnings and errors.
void open_log(const CommonOptions& options, const ServiceInfo& info, MadeLog& made) {
  const std::string name = options.bus.worker.empty() ? info.name : info.name + "-" + options.bus.worker;
  auto console = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  if (!options.verbose) console->set_level(spdlog::level::warn);
  std::vector<spdlog::sink_ptr> sinks{console};
  if (!options.log_dir.empty()) {
    const std::filesystem::path file = options.log_dir / (name + ".log");
    try {
      made.make(file);
      sinks.push_back(std::make_shared<spdlog::sinks::rotating_file_sink_mt>(file.string(), log_file_bytes, log_files));
    } catch (const std::exception& error) {
      throw InputError("cannot write the log {}: {}; choose another --log-dir", file.string(), error.what());
    }
  }
  auto logger = std::make_shared<spdlog::logger>(name, sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::from_str(options.log_level));
  logger->set_formatter(plain_log("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %n: %v"));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

/// Runs `work` and logs its error. Returns the exit code.
int guarded(const MadeLog& made, const std::function<int()>& work) {
  try {
    return work();
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    made.take_back();
    return exit_bad_input;
  } catch (const std::exception& error) {
    spdlog::critical("{}", error.what());
    return exit_failure;
  }
}

int serve(const CommonOptions& options, const ServiceInfo& info, const std::function<void(Service&)>& run,
          MadeLog& made) {
  StopSignal stop;  // before any other thread
  Notifier notifier(options.die_with_parent);
  if (options.die_with_parent) follow_parent();
  open_log(options, info, made);
  for (const std::string& plugin : options.plugins) agents::load_plugin(plugin);
  Service service{options.bus, stop, notifier};
  service.bus.process = info.name;
  if (!service.bus.secure.empty()) service.bus.role = security::role_from_text(info.name.substr(program_prefix.size()));
  std::optional<StandstillWatch> watch;
  if (const auto limit = bus::longest_standstill(service.bus)) watch.emplace(*limit, end_to_be_started_again());
  spdlog::info("process {} starts in run '{}', domain {}", getpid(), options.bus.run, options.bus.domain);
  run(service);
  spdlog::info("ends{}", stop.interrupted() ? " because a signal asked" : "");
  return stop.interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace

int run_service(int argc, char** argv, const ServiceInfo& info, const std::function<void(CLI::App&)>& add_options,
                const std::function<void(Service&)>& run) {
  open_first_log(info.name);
  CLI::App app(info.description, info.name);
  app.formatter(std::make_shared<HelpFormatter>());
  CommonOptions options;
  declare(app, options, info);
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return with_output_written(app.exit(help), info.name);
  } catch (const CLI::ParseError& error) {
    spdlog::error("{}; see {} --help", error.what(), info.name);
    return exit_bad_input;
  }
  MadeLog made;
  const int code = guarded(made, [&] { return serve(options, info, run, made); });
  spdlog::shutdown();
  return code;
}

}  // namespace aloft::runtime
