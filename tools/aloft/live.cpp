#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "common/base/error.hpp"
#include "common/base/follow_parent.hpp"
#include "common/base/stop_signal.hpp"
#include "common/bus/waiter.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/swap_order.hpp"
#include "tools/live/flight_watch.hpp"
#include "tools/live/live_page.hpp"
#include "tools/live/replay.hpp"
#include "tools/live/run_watch.hpp"

namespace aloft::cli {
namespace {

struct LiveOptions {
  std::filesystem::path dir;
  bus::BusOptions bus;
  int port = 0;
  std::string address = "127.0.0.1";
  std::vector<std::string> hosts;
  bool with_control = false;
  bool ends_with_parent = false;
};

/// 128 bits that nobody can guess, in hexadecimal digits.
std::string new_token() {
  std::random_device source;
  std::string token;
  for (int part = 0; part < 4; ++part) token += fmt::format("{:08x}", source());
  return token;
}

/// "/swap?worker=w0&agent=planner" orders what `aloft swap` orders, for those who have the token.
std::map<std::string, http::HttpRoute> swap_routes(const bus::BusOptions& run, const std::string& token,
                                                   StopSignal& stop) {
  const auto swap = [run, &stop](const http::HttpRequest& request) {
    const auto name = [&](const char* what) {
      const auto given = request.query.find(what);
      if (given == request.query.end() || given->second.empty() || !bus::name_objection(given->second).empty())
        throw InputError("{}: '{}' must be a name", request.path, what);
      return given->second;
    };
    SwapOrder order{.place = run, .agent = name("agent")};
    order.place.worker = name("worker");
    return live::json_answer({{"outcome", order_swap(std::move(order), stop)}});
  };
  return {{"/swap", {.answer = swap, .token = token}}};
}

/// Until the user stops it.
void listen(StopSignal& stop, live::RunWatch& run, live::FlightWatch& flights) {
  bus::Waiter waiter(stop);
  std::chrono::milliseconds next{0};
  while (!stop.requested()) {
    waiter.wait(next);
    run.listen();
    next = flights.listen();
  }
}

void wait_for(StopSignal& stop) {
  std::promise<void> stopped;
  const StopSignal::Ticket ticket = stop.on_request([&] { stopped.set_value(); });
  stopped.get_future().wait();
}

int show(const LiveOptions& options) {
  if (options.dir.empty() && options.bus.run.empty())
    throw InputError("aloft live: name a result folder, or --run NAME of a run (aloft status lists them), or both");
  if (options.with_control && options.bus.run.empty())
    throw InputError("aloft live: --operator needs --run NAME: only flights in the air can be swapped");
  if (options.with_control && !options.bus.secure.empty())
    (void)security::check_keys(options.bus.secure, security::Role::run_operator);
  StopSignal stop;  // before any other thread
  if (options.ends_with_parent) follow_parent();
  std::map<std::string, http::HttpRoute> routes = live::page_routes();
  std::optional<live::Replay> replay;
  if (!options.dir.empty()) routes.merge(replay.emplace(options.dir).routes());
  std::optional<live::RunWatch> run;
  std::optional<live::FlightWatch> flights;
  if (!options.bus.run.empty()) {
    spdlog::set_level(spdlog::level::err);
    routes.merge(run.emplace(options.bus).routes());
    routes.merge(flights.emplace(options.bus).routes());
    routes.merge(live::world_routes([&] { return run->experiment(); }));
  }
  const std::string token = options.with_control ? new_token() : "";
  if (options.with_control) routes.merge(swap_routes(options.bus, token, stop));
  routes["/data/overview"] = {[&](const http::HttpRequest&) {
    const auto told = run ? run->experiment() : nullptr;
    nlohmann::json overview = replay ? replay->overview()
                              : told ? live::overview_of(*told)
                                     : live::empty_overview("Run " + options.bus.run);
    overview["run"] = run ? nlohmann::json(options.bus.run) : nlohmann::json();
    overview["stored"] = replay ? nlohmann::json(options.dir.string()) : nlohmann::json();
    overview["operator"] = options.with_control;
    return live::json_answer(overview);
  }};
  const http::HttpServer server(options.address, options.port, std::move(routes), options.hosts);
  fmt::print("http://{}:{}/{}\n", options.address == "0.0.0.0" ? "localhost" : options.address, server.port(),
             token.empty() ? "" : "#token=" + token);
  std::fflush(stdout);
  fmt::print(stderr, "Open this address in a browser; Ctrl-C ends this\n");
  if (run)
    listen(stop, *run, *flights);
  else
    wait_for(stop);
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
  command->add_flag("--operator", options->with_control,
                    "Let those who have the printed address swap agents from the page, as 'aloft swap' does");
  command->add_flag("--die-with-parent", options->ends_with_parent)->group("");  // for aloft run --live
  command->callback([options, &job] { job = [options] { return show(*options); }; });
}

}  // namespace aloft::cli
