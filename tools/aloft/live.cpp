#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/stop_signal.hpp"
#include "common/bus/waiter.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/live/live_page.hpp"
#include "tools/live/replay.hpp"
#include "tools/live/run_watch.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::milliseconds poll_period{100};

struct LiveOptions {
  std::filesystem::path dir;
  bus::BusOptions bus;
  int port = 0;
  std::string address = "127.0.0.1";
  std::vector<std::string> hosts;
};

/// Until the user stops it.
void listen(StopSignal& stop, live::RunWatch* run) {
  if (run == nullptr) {
    std::promise<void> stopped;
    const StopSignal::Ticket ticket = stop.on_request([&] { stopped.set_value(); });
    stopped.get_future().wait();
    return;
  }
  bus::Waiter waiter(stop);
  while (!stop.requested()) {
    waiter.wait(poll_period);
    run->listen();
  }
}

int show(const LiveOptions& options) {
  if (options.dir.empty() && options.bus.run.empty())
    throw InputError("aloft live: name a result folder, or --run NAME of a run (aloft status lists them), or both");
  StopSignal stop;  // before any other thread
  std::map<std::string, http::HttpRoute> routes = live::page_routes();
  std::optional<live::Replay> replay;
  if (!options.dir.empty()) routes.merge(replay.emplace(options.dir).routes());
  std::optional<live::RunWatch> run;
  if (!options.bus.run.empty()) {
    spdlog::set_level(spdlog::level::err);
    routes.merge(run.emplace(options.bus).routes());
  }
  routes["/data/overview"] = {[&](const http::HttpRequest&) {
    nlohmann::json overview = replay ? replay->overview() : live::empty_overview("Run " + options.bus.run);
    overview["run"] = run ? nlohmann::json(options.bus.run) : nlohmann::json();
    return live::json_answer(overview);
  }};
  const http::HttpServer server(options.address, options.port, std::move(routes), options.hosts);
  fmt::print("http://{}:{}/\n", options.address == "0.0.0.0" ? "localhost" : options.address, server.port());
  std::fflush(stdout);
  fmt::print(stderr, "Open this address in a browser; Ctrl-C ends this\n");
  listen(stop, run ? &*run : nullptr);
  return exit_ok;
}

}  // namespace

void add_live(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("live", "Watch a run, or stored flights step by step, in a browser");
  auto options = std::make_shared<LiveOptions>();
  options->bus.run.clear();
  options->bus.process = "aloft-live";
  command->add_option("dir", options->dir, "Result folder of 'aloft run', finished or not, for its flights");
  command->add_option("--run", options->bus.run, "Name of a run, to see how it goes")->check(runtime::bus_name());
  runtime::add_bus_flags(*command, options->bus);
  command->add_option("--http-port", options->port, "Port of the page; 0: any free one")
      ->check(runtime::whole_number(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--http-address", options->address,
                   "Address of this machine for --http-port; 0.0.0.0: all, so that other hosts can read the page")
      ->check(CLI::ValidIPV4)
      ->capture_default_str();
  command
      ->add_option("--http-host", options->hosts,
                   "Further names, separated by commas, under which requests may come, e.g. of a tunnel [none]")
      ->delimiter(',');
  command->callback([options, &job] { job = [options] { return show(*options); }; });
}

}  // namespace aloft::cli
