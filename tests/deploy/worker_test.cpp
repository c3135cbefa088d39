// Runs that are composed of single processes: aloft coordinator, aloft metrics, aloft worker.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "tests/deploy/scene.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool has_stored_flights(const SpreadRun& run) {
  const Finished flights = run_command({"aloft", "export", run.out(), "--flights", "--format", "csv"});
  return flights.exit_code == 0 && std::count(flights.out.begin(), flights.out.end(), '\n') > 1;
}

/// Starts the processes with these gaps, and checks that flights are stored within 10 s of the last necessary start.
/// Further workers start without a gap, because the run could be over after it.
void start_in_order(const std::vector<std::string>& order, const std::vector<std::chrono::milliseconds>& gaps) {
  SpreadRun run(5);
  bool coordinator = false;
  bool metrics = false;
  bool worker = false;
  std::vector<std::unique_ptr<Command>> processes;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!coordinator || !metrics || !worker) std::this_thread::sleep_for(gaps[i]);
    coordinator = coordinator || order[i] == "coordinator";
    metrics = metrics || order[i] == "metrics";
    worker = worker || (order[i] != "coordinator" && order[i] != "metrics");
    if (order[i] == "coordinator")
      processes.push_back(run.coordinator());
    else if (order[i] == "metrics")
      processes.push_back(run.metrics());
    else
      processes.push_back(run.worker(order[i]));
  }
  CHECK(comes_true([&] { return has_stored_flights(run); }, 10s));
  for (auto& process : processes) {
    const Finished finished = process->wait(60s);
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
  }
  CHECK(run.digest() == run.expected_digest());
}

}  // namespace

TEST_CASE("a worker joins late, another leaves early, and the run ends for all with the same digest") {
  SpreadRun run(60);
  const auto metrics = run.metrics();
  const auto coordinator = run.coordinator();
  const auto early = run.worker("early");
  REQUIRE(comes_true([&] { return has_stored_flights(run); }, 20s));

  const auto late = run.worker("late", {"--agents", "min-height,random-walk,dqn"});
  REQUIRE(comes_true([&] { return contains(run.log("aloft-coordinator"), "worker late is here"); }, 30s));
  early->send(SIGTERM);
  CHECK(early->wait(30s).exit_code == 130);
  // The worker has announced its end; the coordinator does not wait for the heartbeat's time-out.
  CHECK(comes_true([&] { return contains(run.log("aloft-coordinator"), "worker early has left"); }, 20s));
  CHECK_FALSE(contains(run.log("aloft-coordinator"), "worker early has been silent"));

  for (const auto* process : {&coordinator, &metrics, &late}) {
    const Finished finished = (*process)->wait(120s);
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
  }
  CHECK(run.digest() == run.expected_digest());
  CHECK_THAT(read_text(run.scratch("out/summary.json")), Contains("\"trials\": 60"));
}

TEST_CASE("workers that fly only some of the agents complement each other; an agent without a worker is named") {
  SpreadRun run(4);
  const auto metrics = run.metrics();
  const auto coordinator = run.coordinator();
  const auto learner = run.worker("learner", {"--agents", "dqn"});
  const auto walker = run.worker("walker", {"--agents", "random-walk"});
  CHECK(comes_true([&] { return contains(run.log("aloft-coordinator"), "no worker flies agent min-height"); }, 30s));
  const auto baseline = run.worker("baseline", {"--agents", "min-height"});
  const Finished finished = coordinator->wait(60s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(metrics->wait(30s).exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}

TEST_CASE("aloft run takes workers that join, and needs none of its own") {
  SpreadRun run(3);
  const auto main = run.start("run", {"--workers", "0"});
  REQUIRE(comes_true([&] { return contains(main->error_so_far(), "aloft worker --join " + run.name()); }, 30s));
  // Neither worker can finish the run alone.
  const auto one = run.worker("one", {"--agents", "dqn,min-height"});
  const auto two = run.worker("two", {"--agents", "random-walk,min-height"});
  const Finished finished = main->wait(60s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(one->wait(30s).exit_code == 0);
  CHECK(two->wait(30s).exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}

TEST_CASE("a discovery server that is killed is started again, and introduces workers that join later") {
  SpreadRun run(4);
  const std::string server = "127.0.0.1:" + std::to_string(12000 + getpid() % 20000);
  const auto main = run.start("run", {"--workers", "0", "--discovery-server", server});
  // No learner yet: the run cannot end before the late worker is introduced.
  const auto early = run.worker("early", {"--agents", "min-height,random-walk", "--discovery-server", server});
  REQUIRE(comes_true([&] { return contains(run.log("aloft-coordinator"), "worker early is here"); }, 20s));
  for (const int pid : processes_with(run.name()))
    if (contains(read_text("/proc/" + std::to_string(pid) + "/cmdline"), "aloft-discovery-server")) kill(pid, SIGKILL);
  const auto late = run.worker("late", {"--agents", "dqn", "--discovery-server", server});
  CHECK(comes_true([&] { return contains(run.log("aloft-coordinator"), "worker late is here"); }, 30s));
  CHECK_THAT(main->error_so_far(), Contains("aloft-discovery-server was ended by signal 9"));
  CHECK_FALSE(contains(run.log("aloft-coordinator"), "worker early has been silent"));
  const Finished finished = main->wait(120s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(early->wait(30s).exit_code == 0);
  CHECK(late->wait(30s).exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}

TEST_CASE("the processes start in any order") {
  start_in_order({"one", "two", "metrics", "coordinator"}, {0s, 0s, 1s, 1s});
  start_in_order({"coordinator", "one", "metrics"}, {0s, 500ms, 2s});
  start_in_order({"metrics", "coordinator", "one"}, {0s, 0s, 0s});
}

TEST_CASE("the processes start in every order, with gaps up to 5 s", "[.][soak]") {
  std::vector<std::string> order{"coordinator", "metrics", "one", "two"};
  std::mt19937 random(1);
  do {
    std::vector<std::chrono::milliseconds> gaps;
    for (std::size_t i = 0; i < order.size(); ++i) gaps.emplace_back(random() % 5001);
    start_in_order(order, gaps);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("a worker names the coordinator that it waits for, and gives up") {
  const SpreadRun run(1);
  const Finished alone = run.worker("alone", {"--wait", "6"})->wait(30s);
  CHECK(alone.exit_code == 1);
  CHECK_THAT(alone.err, Contains("no coordinator of run '" + run.name() + "' for 4 s, since 20") &&
                            Contains("gave up") && Contains("aloft coordinator EXPERIMENT"));
}

TEST_CASE("a worker refuses an agent that the run does not have, and a name that is taken") {
  SpreadRun run(200);
  const auto main = run.start("run", {"--workers", "1"});
  const Finished wrong = run.worker("wrong", {"--agents", "min-hight"})->wait(30s);
  CHECK(wrong.exit_code == 2);
  CHECK_THAT(wrong.err, Contains("min-hight") && Contains("Did you mean 'min-height'?"));
  const Finished taken = run.worker("w0")->wait(30s);
  CHECK(taken.exit_code == 2);
  CHECK_THAT(taken.err, Contains("has a worker of that name already"));
  main->send(SIGINT);
  CHECK(main->wait(30s).exit_code == 130);
}

TEST_CASE("an interface that this machine does not have, and a server that cannot be reached, are refused") {
  const SpreadRun run(1);
  const Finished interface = run.worker("one", {"--interface", "eth77"})->wait(30s);
  CHECK(interface.exit_code == 2);
  CHECK_THAT(interface.err, Contains("--interface eth77") && Contains("lo (127.0.0.1)"));
  const Finished outside = run.worker("one", {"--discovery-server", "192.0.2.1:11811"})->wait(30s);
  CHECK(outside.exit_code == 2);
  CHECK_THAT(outside.err, Contains("add --interface"));
  const Finished port = run.worker("one", {"--discovery-server", "127.0.0.1"})->wait(30s);
  CHECK(port.exit_code == 2);
  CHECK_THAT(port.err, Contains("ADDRESS:PORT"));
}

TEST_CASE("60 processes on one host find each other within 15 s", "[.][soak]") {
  SpreadRun run(60);
  const auto main = run.start("run", {"--workers", "14"});  // 14 * 4 + coordinator, collector and the command itself
  CHECK(comes_true([&] { return contains(run.log("aloft-coordinator"), "14 workers"); }, 15s));
  const Finished finished = main->wait(300s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}
