#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <map>

#include "common/base/error.hpp"
#include "common/base/text_layout.hpp"
#include "common/bus/waiter.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "services/status/run_observer.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/table_options.hpp"

namespace aloft::cli {
namespace {

using status::Clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds poll_period{100};
constexpr std::chrono::milliseconds redraw_period{500};
constexpr std::chrono::milliseconds record_period{1000};
constexpr std::chrono::milliseconds plain_line_period{5000};
// Processes announce themselves, and runs publish their status, every 0.5 s.
constexpr std::chrono::milliseconds settle_time{1000};

struct StatusOptions {
  bus::BusOptions bus;
  bool any_run = false;
  bool watch = false;
  double wait_s = 5.0;
  std::string format;
  TableOptions table;
};

/// Listens to the run that was asked for, or to all that there are.
class Observer {
 public:
  explicit Observer(const StatusOptions& options) : options_(options), participant_(options.bus) {
    if (!options_.any_run) observe(options_.bus.run);
  }

  void listen() {
    if (options_.any_run)
      for (const std::string& run : participant_.runs()) observe(run);
    for (auto& [name, run] : runs_) run.listen();
  }

  /// All runs found so far have published everything that is shown.
  [[nodiscard]] bool complete() const {
    return std::ranges::all_of(runs_, [](const auto& run) { return run.second.view().complete(); });
  }

  [[nodiscard]] Json to_json() const {
    Json runs = Json::array();
    for (const auto& [name, run] : runs_)
      if (run.view().heard()) runs.push_back(run.view().to_json(Clock::now()));
    return {{"domain", options_.bus.domain}, {"runs", std::move(runs)}};
  }

 private:
  void observe(const std::string& run) {
    bus::BusOptions place = options_.bus;
    place.run = run;
    runs_.try_emplace(run, place);
  }

  const StatusOptions& options_;
  bus::Participant participant_;
  std::map<std::string, status::RunObserver> runs_;
};

/// JSON in ASCII, so that no text from the wire is a command to the terminal.
std::string dump(const Json& json, int indent) {
  return json.dump(indent, ' ', true, Json::error_handler_t::replace) + "\n";
}

std::string nobody(const StatusOptions& options) {
  return fmt::format(
      "{} in domain {} on {}: nobody published RunStatus or WorkerStatus within {:g} s. Is it running, in another "
      "--domain{}{}?",
      options.any_run ? "no run" : fmt::format("no run '{}'", options.bus.run), options.bus.domain,
      fmt::join(options.bus.interfaces, ", "), options.wait_s,
      options.any_run ? "" : ", under another name (aloft status without --run lists all)",
      options.bus.secure.empty() ? ", secured (--secure)" : ", secured by another authority");
}

/// The text to show; empty if there is no run.
std::string picture(const StatusOptions& options, const Json& news, bool terminal) {
  if (options.format == "json") return dump(news, options.watch ? -1 : 2);
  const bool brief = options.table.brief || (options.watch && !terminal);
  const std::size_t width = options.table.shape().width;
  std::string text;
  for (const Json& run : news["runs"])
    text += brief ? cut_to(status::run_line(run), width) + "\n" : status::run_text(run, width);
  return text;
}

int watch(const StatusOptions& options, Observer& observer, StopSignal& stop) {
  constexpr std::string_view clear_screen = "\033[H\033[2J";
  const bool terminal = options.format == "text" && isatty(STDOUT_FILENO) == 1;
  const auto period = terminal ? redraw_period : options.format == "json" ? record_period : plain_line_period;
  bus::Waiter waiter(stop);
  auto next = Clock::now() + settle_time;
  while (!stop.requested()) {
    waiter.wait(poll_period);
    observer.listen();
    if (Clock::now() < next) continue;
    next = Clock::now() + period;
    const Json news = observer.to_json();
    std::string text = picture(options, news, terminal);
    if (text.empty()) text = fmt::format("no run in domain {} yet; Ctrl-C ends this\n", options.bus.domain);
    fmt::print("{}{}", terminal ? clear_screen : "", text);
    if (std::fflush(stdout) != 0) throw std::runtime_error("cannot write to standard output");
  }
  return exit_ok;
}

int once(const StatusOptions& options, Observer& observer, StopSignal& stop) {
  bus::Waiter waiter(stop);
  const auto start = Clock::now();
  const auto limit = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.wait_s));
  const auto settled = std::min(limit, start + settle_time);
  while (!stop.requested() && Clock::now() < limit) {
    waiter.wait(poll_period);
    observer.listen();
    if (Clock::now() >= settled && observer.complete() && !observer.to_json()["runs"].empty()) break;
  }
  if (stop.requested()) return exit_interrupted;
  const Json news = observer.to_json();
  if (options.format == "json" || !news["runs"].empty()) fmt::print("{}", picture(options, news, false));
  std::fflush(stdout);
  if (!news["runs"].empty()) return exit_ok;
  fmt::print(stderr, "aloft status: {}\n", nobody(options));
  return exit_failure;
}

int show_status(const StatusOptions& options) {
  StopSignal stop;  // before any other thread
  spdlog::set_level(spdlog::level::err);
  Observer observer(options);
  return options.watch ? watch(options, observer, stop) : once(options, observer, stop);
}

}  // namespace

void add_status(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("status", "Show the runs in a domain: progress, workers, agents, leases, rates, errors");
  auto options = std::make_shared<StatusOptions>();
  options->bus.run.clear();
  options->bus.process = "aloft-status";
  command->add_option("--run", options->bus.run, "Name of the run [all that are there]")->check(runtime::bus_name());
  runtime::add_bus_flags(*command, options->bus);
  command->add_flag("--watch", options->watch, "Go on until Ctrl-C: redraws a terminal, else prints a line every 5 s");
  command->add_option("--wait", options->wait_s, "Seconds to wait for the first news")
      ->check(runtime::number(0.1, 600))
      ->capture_default_str();
  add_format(*command, options->format, {"text", "json"});
  options->table.add_to(*command, "One line per run");
  command->callback([options, &job] {
    options->any_run = options->bus.run.empty();
    job = [options] { return show_status(*options); };
  });
}

}  // namespace aloft::cli
