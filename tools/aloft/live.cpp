#include <fmt/format.h>

#include <cstdio>
#include <future>

#include "common/base/error.hpp"
#include "common/base/stop_signal.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/live/live_page.hpp"
#include "tools/live/replay.hpp"

namespace aloft::cli {
namespace {

struct LiveOptions {
  std::filesystem::path dir;
  int port = 0;
  std::string address = "127.0.0.1";
  std::vector<std::string> hosts;
};

int show(const LiveOptions& options) {
  StopSignal stop;  // before any other thread
  std::map<std::string, http::HttpRoute> routes = live::page_routes();
  const live::Replay replay(options.dir);
  routes.merge(replay.routes());
  const http::HttpServer server(options.address, options.port, std::move(routes), options.hosts);
  fmt::print("http://{}:{}/\n", options.address == "0.0.0.0" ? "localhost" : options.address, server.port());
  std::fflush(stdout);
  fmt::print(stderr, "Open this address in a browser; Ctrl-C ends this\n");
  std::promise<void> stopped;
  const StopSignal::Ticket ticket = stop.on_request([&] { stopped.set_value(); });
  stopped.get_future().wait();
  return exit_ok;
}

}  // namespace

void add_live(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("live", "Watch stored flights in a browser: play, pause, step by step");
  auto options = std::make_shared<LiveOptions>();
  command->add_option("dir", options->dir, "Result folder of 'aloft run', finished or not")->required();
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
