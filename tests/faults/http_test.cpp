// HTTP clients that occupy connections while a run flies: the collector still answers, and the run is not affected.
#include <arpa/inet.h>
#include <httplib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <regex>
#include <thread>

#include "tests/faults/fault_scene.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

/// Connections to one port that are opened again whenever they are closed. Every second one sends a request byte by
/// byte, without end; the others say nothing.
class Crowd {
 public:
  Crowd(int port, std::size_t size) : port_(port), connections_(size, -1) {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    before_ = files;
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    push();
  }
  ~Crowd() {
    for (const int connection : connections_) close(connection);
    setrlimit(RLIMIT_NOFILE, &before_);
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// Returns how many connections had been closed.
  std::size_t push() {
    std::size_t closed = 0;
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      char byte = 0;
      const bool open = connections_[i] >= 0 && recv(connections_[i], &byte, 1, MSG_DONTWAIT) < 0 && errno == EAGAIN;
      if (!open) {
        closed += connections_[i] >= 0 ? 1U : 0U;
        if (connections_[i] >= 0) close(connections_[i]);
        connections_[i] = connect_again();
        if (i % 2 == 0) send_text(connections_[i], "GET /healthz HTTP/1.1\r\nX: ");
      }
      if (i % 2 == 0) send_text(connections_[i], "x");
    }
    return closed;
  }

 private:
  [[nodiscard]] int connect_again() const {
    const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return connection;
    close(connection);  // the run is over
    return -1;
  }

  static void send_text(int connection, std::string_view text) {
    (void)::send(connection, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  int port_;
  std::vector<int> connections_;
  rlimit before_{};
};

/// Reads the port from the collector's log.
int port_of(const FaultScene& scene, const std::string& name) {
  std::smatch found;
  std::string log;
  const bool there = eventually(30s, [&] {
    log = scene.log(name, "aloft-metrics");
    return std::regex_search(log, found, std::regex("http://127.0.0.1:([0-9]+)/"));
  });
  REQUIRE(there);
  return std::stoi(found[1]);
}

}  // namespace

TEST_CASE("a thousand slow and idle HTTP clients block no other client and no run", "[http]") {
  const FaultScene scene(12);
  const std::string run = own_name("crowd");
  const std::string out = scene.out("crowd").string();
  const auto start = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), {"--domain", test_domain()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Command>(arguments);
  };
  const std::vector<std::string> same{scene.experiment().string(), "--run", run, "--out", out};
  std::vector<std::string> metrics_arguments{"aloft", "metrics"};
  metrics_arguments.insert(metrics_arguments.end(), same.begin(), same.end());
  std::vector<std::string> coordinator_arguments{"aloft", "coordinator"};
  coordinator_arguments.insert(coordinator_arguments.end(), same.begin(), same.end());

  const auto metrics = start(metrics_arguments, {"--http-port", "0"});
  const auto coordinator = start(coordinator_arguments, {});
  const int port = port_of(scene, "crowd");
  httplib::Client client("127.0.0.1", port);
  client.set_connection_timeout(10 * slowdown);
  client.set_read_timeout(10 * slowdown);
  REQUIRE(client.Get("/healthz"));
  const std::size_t before = resident_bytes(metrics->pid());

  Crowd crowd(port, 1000);
  const auto worker = start({"aloft", "worker", "--join", run}, {"--log-dir", (scene.out("log")).string()});
  std::size_t dropped = 0;
  std::size_t most = 0;
  int answers = 0;
  while (coordinator->running()) {
    dropped += crowd.push();
    for (const char* path : {"/healthz", "/status"}) {
      const auto answer = client.Get(path);
      // The run may have ended meanwhile.
      if (!answer && !eventually(10s, [&] { return !metrics->running(); })) FAIL("no answer from " << path);
      answers += answer && answer->status == 200 ? 1 : 0;
    }
    most = std::max(most, resident_bytes(metrics->pid()));
    std::this_thread::sleep_for(200ms);
  }
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(metrics->wait().exit_code == 0);
  CHECK(worker->wait().exit_code == 0);
  CHECK(scene.digest("crowd") == scene.reference());
  CHECK(answers > 2);
  CHECK(dropped > 800);  // the server keeps no more
  if (memory_tells) CHECK(most < before + (32U << 20U));
}
