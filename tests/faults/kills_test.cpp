// Processes that are killed, stopped and started again in the middle of a run: the same bytes as in one process.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <iostream>
#include <map>
#include <numeric>
#include <thread>

#include "common/base/random.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// Sleeps, but not longer than the command runs.
void sleep_while_running(Command& run, Clock::duration time) {
  const auto until = Clock::now() + time;
  while (run.running() && Clock::now() < until) std::this_thread::sleep_for(5ms);
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("a random process of four workers is killed every 0.5 to 2 s", "[kills]") {
  const FaultScene scene(40);  // trials: enough that even a fast machine still flies at the first kill
  const int seeds = effort(20, 200);

  std::vector<double> times_s;
  std::vector<double> undisturbed_s;  // measured repeatedly, because the machine's load varies
  int kills = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    auto started = Clock::now();
    if (seed % 10 == 0) {
      auto undisturbed = scene.start("undisturbed", {"--workers", "4"});
      scene.check_finished("undisturbed", *undisturbed, 300s);
      undisturbed_s.push_back(seconds_since(started));
      std::filesystem::remove_all(scene.out("undisturbed"));
    }
    RandomStream random(static_cast<std::uint64_t>(seed), 0, "kills");
    const std::string name = fmt::format("seed-{}", seed);
    started = Clock::now();
    auto run = scene.start(name, {"--workers", "4"});
    std::vector<std::string> killed;
    while (run->running()) {
      sleep_while_running(*run, std::chrono::microseconds(500'000 + random.uniform_index(1'500'000)));
      const std::vector<int> services = scene.services(name, *run);
      if (!run->running() || services.empty()) break;
      const int victim = services[random.uniform_index(static_cast<std::uint32_t>(services.size()))];
      killed.push_back(command_line(victim));
      kill(victim, SIGKILL);
    }
    INFO("seed " << seed << "; killed: " << fmt::format("{}", fmt::join(killed, "\n")));
    scene.check_finished(name, *run, 300s);
    std::filesystem::remove_all(scene.out(name));
    times_s.push_back(seconds_since(started));
    kills += static_cast<int>(killed.size());
    if (soak())
      std::cout << fmt::format("seed {}: {} kills, {:.1f} s", seed, killed.size(), times_s.back()) << std::endl;
  }
  const double ratio = mean(times_s) / mean(undisturbed_s);
  WARN(fmt::format("{} kills in {} runs; {:.1f} s per run, {:.1f} s undisturbed: {:.2f} times as long", kills, seeds,
                   mean(times_s), mean(undisturbed_s), ratio));
  CHECK(kills >= seeds / 2);  // some runs are over before their first kill
  if (soak()) CHECK(ratio < 2.5);
}

TEST_CASE("the command itself is killed, and the same command goes on", "[kills]") {
  const FaultScene scene;
  auto run = scene.start("resumed", {"--workers", "2"});
  for (int part = 1; part <= 3; ++part) {
    scene.wait_for_flights("resumed", *run, scene.flights() * part / 4);
    run->send(SIGKILL);
    (void)run->wait();
    // The services end with the command that started them.
    CHECK(eventually(20s, [&] { return scene.services("resumed", *run).empty(); }));
    run = scene.start("resumed", {"--workers", "2"});
  }
  scene.check_finished("resumed", *run, 120s);
}

namespace {

/// A run whose processes the test starts one by one; no supervisor restarts or ends them.
class LooseRun {
 public:
  LooseRun(const FaultScene& scene, std::string name) : scene_(scene), name_(std::move(name)) {}

  using Group = std::map<std::string, std::unique_ptr<Command>>;  // by name of the log

  [[nodiscard]] std::unique_ptr<Command> collector() const { return start("aloft-metrics", results()); }
  [[nodiscard]] std::unique_ptr<Command> coordinator() const {
    auto options = results();
    options.insert(options.end(), {"--heartbeat-timeout", "0.8"});
    return start("aloft-coordinator", options);
  }
  [[nodiscard]] Group worker(const std::string& worker) const {
    Group group = worker_without_learner(worker);
    group["aloft-learning-agent-" + worker] = start("aloft-learning-agent", {"--worker", worker});
    return group;
  }
  [[nodiscard]] Group worker_without_learner(const std::string& worker) const {
    Group group;
    for (const std::string program : {"aloft-environment", "aloft-channel", "aloft-baseline-agent"})
      group[program + "-" + worker] = start(program, {"--worker", worker});
    return group;
  }
  static void send(const Group& group, int signal) {
    for (const auto& [log, process] : group) process->send(signal);
  }
  /// Checks that the processes receive the end of the run and end with exit code 0.
  void check_ends(const Group& group) const {
    INFO(scene_.log(name_, "aloft-coordinator"));
    for (const auto& [log, process] : group) {
      INFO(scene_.log(name_, log));
      CHECK(process->wait(20s).exit_code == 0);
    }
  }

 private:
  [[nodiscard]] std::vector<std::string> results() const {
    return {"--results", scene_.out(name_).string(), "--experiment",
            (scene_.out("reference") / "experiment.json").string()};
  }
  [[nodiscard]] std::unique_ptr<Command> start(const std::string& program, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{program,       "--run",     fmt::format("loose-{}", getpid()),   "--domain",
                                       test_domain(), "--log-dir", (scene_.out(name_) / "log").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Command>(arguments);
  }

  const FaultScene& scene_;
  std::string name_;
};

}  // namespace

TEST_CASE("a worker stops for longer than its lease, and comes back with late results", "[stops]") {
  const FaultScene scene(60);
  const std::string name = "stopped";
  const LooseRun run(scene, name);
  const auto metrics = run.collector();
  const auto coordinator = run.coordinator();
  const LooseRun::Group w0 = run.worker("w0");
  const LooseRun::Group w1 = run.worker("w1");
  const auto times_lost = [&] {
    const std::string log = scene.log(name, "aloft-coordinator");
    int times = 0;
    for (auto at = log.find("has been silent"); at != std::string::npos; at = log.find("has been silent", at + 1))
      ++times;
    return times;
  };

  // First one worker is stopped, and the other takes over its trials, but cannot finish the run, because the collector
  // is stopped, too. Then both workers are stopped; when they continue, their leases are over and not given to others.
  int round = 0;
  const std::vector<int> eighths = soak() ? std::vector{1, 4, 6} : std::vector{1, 4};
  for (const int eighth : eighths) {
    scene.wait_for_flights(name, *coordinator, scene.flights() * eighth / 8);
    ++round;
    const int lost_before = times_lost();
    LooseRun::send(w0, SIGSTOP);
    round == 1 ? metrics->send(SIGSTOP) : LooseRun::send(w1, SIGSTOP);
    CHECK(eventually(30s, [&] { return times_lost() > lost_before; }));
    std::this_thread::sleep_for(1s);
    LooseRun::send(w0, SIGCONT);
    round == 1 ? metrics->send(SIGCONT) : LooseRun::send(w1, SIGCONT);
  }
  CHECK(coordinator->wait(120s).exit_code == 0);
  CHECK(metrics->wait(20s).exit_code == 0);
  run.check_ends(w0);
  run.check_ends(w1);
  CHECK(times_lost() >= round);
  CHECK(scene.digest(name) == scene.reference());
}

TEST_CASE("a process that is silent at the end of the run still receives the end when it continues", "[stops]") {
  const FaultScene scene;
  const std::string name = "absent";
  const LooseRun run(scene, name);
  const auto metrics = run.collector();
  const auto coordinator = run.coordinator();
  const LooseRun::Group lost = run.worker_without_learner("w0");  // cannot finish the run alone
  scene.wait_for_flights(name, *coordinator, 1);
  LooseRun::send(lost, SIGSTOP);
  std::this_thread::sleep_for(3s);  // longer than the lease after which peers forget it
  const LooseRun::Group other = run.worker("w1");
  CHECK(eventually(30s, [&] {
    return scene.log(name, "aloft-coordinator").find("waits until these are back") != std::string::npos;
  }));
  CHECK(coordinator->running());
  LooseRun::send(lost, SIGCONT);
  const bool ends = eventually(20s, [&] { return !coordinator->running(); });
  INFO(scene.log(name, "aloft-coordinator"));
  INFO(scene.log(name, "aloft-environment-w0"));
  REQUIRE(ends);
  CHECK(coordinator->wait(20s).exit_code == 0);
  CHECK(metrics->wait(20s).exit_code == 0);
  run.check_ends(lost);
  run.check_ends(other);
  CHECK(scene.digest(name) == scene.reference());
}
