// Processes that are killed, stopped and started again in the middle of a run: the same bytes as in one process.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <iostream>
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
  const FaultScene scene(effort(20, 40));
  const int seeds = effort(20, 200);

  std::vector<double> times_s;
  std::vector<double> undisturbed_s;  // measured again and again: the machine has other work, too
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
  CHECK(kills >= seeds / 2);  // a fast machine finishes some runs before their first kill
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

TEST_CASE("a worker stops for longer than its lease, and comes back with late results", "[stops]") {
  const FaultScene scene(60);
  const std::string name = "stopped";
  const auto service = [&](const std::string& program, std::vector<std::string> more) {
    std::vector<std::string> arguments{program,       "--run",     fmt::format("stop-{}", getpid()),  "--domain",
                                       test_domain(), "--log-dir", (scene.out(name) / "log").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Command>(arguments);
  };
  const std::vector<std::string> results{"--results", scene.out(name).string(), "--experiment",
                                         (scene.out("reference") / "experiment.json").string()};
  const auto metrics = service("aloft-metrics", results);
  auto coordinator_options = results;
  coordinator_options.insert(coordinator_options.end(), {"--heartbeat-timeout", "0.8"});
  const auto coordinator = service("aloft-coordinator", coordinator_options);
  std::vector<std::vector<std::unique_ptr<Command>>> workers(2);
  for (std::size_t i = 0; i < workers.size(); ++i)
    for (const char* program : {"aloft-environment", "aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"})
      workers[i].push_back(service(program, {"--worker", fmt::format("w{}", i)}));
  const auto send = [](const std::vector<std::unique_ptr<Command>>& worker, int signal) {
    for (const auto& process : worker) process->send(signal);
  };
  const auto times_lost = [&] {
    const std::string log = scene.log(name, "aloft-coordinator");
    int times = 0;
    for (auto at = log.find("has been silent"); at != std::string::npos; at = log.find("has been silent", at + 1))
      ++times;
    return times;
  };

  // First one worker stops, and the other takes over its trials; but it cannot finish the run, because the collector
  // stands still, too. Then both workers: they come back to leases that were taken away and given to nobody.
  int round = 0;
  const std::vector<int> eighths = soak() ? std::vector{1, 4, 6} : std::vector{1, 4};
  for (const int eighth : eighths) {
    scene.wait_for_flights(name, *coordinator, scene.flights() * eighth / 8);
    ++round;
    const int lost_before = times_lost();
    send(workers[0], SIGSTOP);
    round == 1 ? metrics->send(SIGSTOP) : send(workers[1], SIGSTOP);
    CHECK(eventually(30s, [&] { return times_lost() > lost_before; }));
    std::this_thread::sleep_for(1s);
    send(workers[0], SIGCONT);
    round == 1 ? metrics->send(SIGCONT) : send(workers[1], SIGCONT);
  }
  CHECK(coordinator->wait(120s).exit_code == 0);
  CHECK(metrics->wait(20s).exit_code == 0);
  for (const auto& worker : workers)
    for (const auto& process : worker) CHECK(process->wait(20s).exit_code == 0);
  CHECK(times_lost() >= round);
  CHECK(scene.digest(name) == scene.reference());
}
