#include "services/coordinator/coordinator.hpp"

#include <spdlog/spdlog.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace aloft;
using namespace aloft::coordinator;
using namespace std::chrono_literals;

namespace {

const Clock::time_point start{};
const bool quiet = (spdlog::set_level(spdlog::level::off), true);

experiment::Experiment small_experiment() {
  experiment::Experiment experiment;
  experiment.name = "small";
  experiment.trials = 2;
  experiment.max_attempts = 2;
  for (const char* name : {"density=1", "density=5"}) {
    experiment::Condition condition;
    condition.index = static_cast<std::uint32_t>(experiment.conditions.size());
    condition.name = name;
    experiment.conditions.push_back(condition);
  }
  for (const char* name : {"min-height", "dqn"})
    experiment.agents.push_back(agents::parse_agents(name, "agents").front());
  return experiment;
}

WorkerNews news(std::string_view name, std::vector<std::uint64_t>& leases, std::uint32_t capacity = 1) {
  WorkerNews news;
  news.report = {name, 1, capacity, leases};
  return news;
}

}  // namespace

TEST_CASE("a run from the first worker to the last flight", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 100, start);
  std::vector<std::uint64_t> leases;
  auto now = start;
  std::size_t trials = 0;
  while (!coordinator.over()) {
    coordinator.on_worker(news("w0", leases), now);
    const auto orders = coordinator.tick(now);
    REQUIRE(orders.size() == 1);
    CHECK(orders[0].agents == std::vector<std::string>{"min-height", "dqn"});
    CHECK(orders[0].attempt == 1);
    for (const auto& agent : orders[0].agents)
      CHECK(coordinator.on_flight_stored({orders[0].condition, orders[0].trial, agent}, now));
    ++trials;
    now += 100ms;
  }
  CHECK(trials == 4);
  CHECK(coordinator.succeeded());
  const Progress progress = coordinator.progress(now);
  CHECK(progress.flights_stored == 8);
  CHECK(progress.flights_total == 8);
  CHECK(progress.trials_done == 4);
  CHECK(progress.message.empty());
}

TEST_CASE("flights of another experiment are not counted", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  CHECK_FALSE(coordinator.on_flight_stored({2, 0, "dqn"}, start));
  CHECK_FALSE(coordinator.on_flight_stored({0, 2, "dqn"}, start));
  CHECK_FALSE(coordinator.resume({0, 0, "planner"}));
  CHECK(coordinator.progress(start).flights_stored == 0);
}

TEST_CASE("a resumed run listens for flights in the air before it hands out trials", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  CHECK(coordinator.resume({0, 0, "min-height"}));
  std::vector<std::uint64_t> none;
  std::vector<std::uint64_t> in_the_air{(0ULL << 32U) | 77U};  // trial 0 of condition 0
  coordinator.on_worker(news("w1", none), start + 200ms);
  CHECK(coordinator.tick(start + 200ms).empty());
  coordinator.on_worker(news("w0", in_the_air), start + 400ms);
  const auto orders = coordinator.tick(start + 1s);
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].worker == "w1");
  CHECK(orders[0].trial == 1);
}

TEST_CASE("leases held without right are cancelled", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  for (const char* agent : {"min-height", "dqn"}) coordinator.on_flight_stored({0, 1, agent}, start);
  std::vector<std::uint64_t> stale{(1ULL << 32U) | 5U};
  coordinator.on_worker(news("w0", stale), start);
  const auto orders = coordinator.tick(start);
  REQUIRE(orders.size() == 2);
  CHECK(orders[0].cancelled);
  CHECK(orders[0].worker == "w0");
  CHECK(orders[0].lease == stale[0]);
  CHECK(orders[0].trial == 1);
  CHECK_FALSE(orders[1].cancelled);
}

TEST_CASE("failures are named with their reason and reported at the end", "[coordinator]") {
  const auto experiment = small_experiment();
  CoordinatorOptions options;
  SECTION("the rest goes on") {}
  SECTION("unless told otherwise") {
    options.fail_fast = 1;
  }
  Coordinator coordinator(experiment, options, 0, start);
  coordinator.on_flight_stored({0, 0, "min-height"}, start);
  std::vector<std::uint64_t> leases;
  for (int round = 0; round < 20 && !coordinator.over(); ++round) {
    WorkerNews report = news("w0", leases);
    coordinator.on_worker(report, start);
    for (const Order& order : coordinator.tick(start)) {
      if (order.condition == 0 && order.trial == 0) {
        report.failed_leases = {{order.lease, "no command from dqn for 60 s"}};
        coordinator.on_worker(report, start);
        CHECK_THAT(coordinator.progress(start).message, Catch::Contains("trial 0 of condition 0 (density=1) failed") &&
                                                            Catch::Contains("worker w0: no command from dqn"));
        coordinator.on_worker(report, start);  // reports repeat their failures
      } else {
        for (const auto& agent : order.agents)
          coordinator.on_flight_stored({order.condition, order.trial, agent}, start);
      }
    }
  }
  REQUIRE(coordinator.over());
  CHECK_FALSE(coordinator.succeeded());
  CHECK(coordinator.failure_report() ==
        std::vector<std::string>{"trial 0 of condition 0 (density=1) (agents dqn): no command from dqn for 60 s"});
  if (options.fail_fast == 0) CHECK(coordinator.progress(start).trials_done == 3);
}

TEST_CASE("the status names what the run waits for", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  CHECK(coordinator.progress(start + 3s).message.empty());
  CHECK(coordinator.progress(start + 7s).message == "no worker for 7 s; waiting for one to join");

  std::vector<std::uint64_t> leases;
  WorkerNews report = news("w0", leases);
  report.waits_for = "agent 'dqn' since 4 s";
  coordinator.on_worker(report, start + 10s);
  CHECK(coordinator.progress(start + 10s).message == "worker w0 waits for agent 'dqn' since 4 s");

  report.waits_for = "";
  report.records_unconfirmed = 3;
  coordinator.on_worker(report, start + 12s);
  CHECK(coordinator.progress(start + 12s).message.empty());
  CHECK(coordinator.progress(start + 14s).message ==
        "3 finished flights have not been stored for 4 s; waiting for aloft-metrics");

  WorkerNews other = news("w1", leases);
  other.records_unconfirmed = 2;
  coordinator.on_worker(other, start + 14s);
  CHECK_THAT(coordinator.progress(start + 14s).message, Catch::Contains("5 finished flights"));
  other.report.capacity = 0;  // it leaves
  coordinator.on_worker(other, start + 14s);
  CHECK_THAT(coordinator.progress(start + 14s).message, Catch::Contains("3 finished flights"));

  (void)coordinator.tick(start + 15500ms);  // 3.5 s after its last report
  CHECK(coordinator.progress(start + 15500ms).workers_alive == 0);
  CHECK_THAT(coordinator.progress(start + 15500ms).message, Catch::Contains("worker w0 has been silent for 3.5 s"));
}

TEST_CASE("a collector that cannot store is named, until it can", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  coordinator.on_collector_paused("aloft-metrics: disk full", start + 1s);
  CHECK(coordinator.progress(start + 2s).message == "aloft-metrics: disk full");
  CHECK_THAT(coordinator.progress(start + 5s).message, !Catch::Contains("disk full"));
}

TEST_CASE("rates follow the flights and steps of the last seconds", "[coordinator]") {
  auto experiment = small_experiment();
  experiment.trials = 1000;
  Coordinator coordinator(experiment, {}, 0, start);
  std::vector<std::uint64_t> leases;
  WorkerNews report = news("w0", leases, 1);
  report.steps_done = 1'000'000;  // before this coordinator started
  coordinator.on_worker(report, start);
  for (std::uint32_t second = 1; second <= 60; ++second) {
    report.steps_done += 500;
    coordinator.on_worker(report, start + second * 1s);
    for (std::uint32_t i = 0; i < 5; ++i) coordinator.on_flight_stored({0, 5 * second + i, "dqn"}, start);
    (void)coordinator.tick(start + second * 1s);
  }
  CHECK(coordinator.progress(start + 60s).steps_per_s == Approx(500).epsilon(0.01));
  CHECK(coordinator.progress(start + 60s).flights_per_s == Approx(5).epsilon(0.01));
}

TEST_CASE("two workers of one name cost no attempts; their trials go to others until one of them is gone",
          "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  std::vector<std::uint64_t> none;
  std::vector<std::uint64_t> leases;
  const auto speak = [&](std::uint64_t incarnation, std::vector<std::uint64_t>& held, Clock::time_point now,
                         std::uint32_t capacity = 2) {
    WorkerNews report = news("w0", held, capacity);
    report.report.incarnation = incarnation;
    report.host = incarnation == 1 ? "alpha" : "beta";
    report.pid = static_cast<std::uint32_t>(incarnation);
    coordinator.on_worker(report, now);
  };
  speak(1, none, start);
  for (const Order& order : coordinator.tick(start)) leases.push_back(order.lease);
  REQUIRE(leases.size() == 2);
  speak(1, leases, start + 100ms);
  speak(2, none, start + 200ms);
  (void)coordinator.tick(start + 200ms);
  for (int flip = 0; flip < 50; ++flip) {
    const auto now = start + 300ms + flip * 200ms;
    speak(1, leases, now);
    speak(2, none, now + 100ms);
    for (const Order& order : coordinator.tick(now + 100ms)) CHECK(order.cancelled);
    CHECK_THAT(coordinator.progress(now + 100ms).message,
               Catch::Contains("2 workers are called w0: on host alpha (process 1) and on host beta (process 2)"));
  }
  CHECK(coordinator.progress(start + 11s).trials_failed == 0);
  const auto end = start + 12s;
  speak(2, none, end, 0);
  speak(1, none, end);
  const auto orders = coordinator.tick(end);
  REQUIRE(orders.size() == 2);
  for (const Order& order : orders) {
    CHECK_FALSE(order.cancelled);
    CHECK(order.attempt <= 2);  // the second one was taken for a restart of the first
  }
  CHECK(coordinator.progress(end).message.find("called w0") == std::string::npos);
}

TEST_CASE("flights that count as stored but are not among the results are found", "[coordinator]") {
  const auto experiment = small_experiment();
  Coordinator coordinator(experiment, {}, 0, start);
  coordinator.on_flight_stored({0, 1, "min-height"}, start);
  coordinator.on_flight_stored({1, 0, "dqn"}, start);
  std::vector<bool> is_there(8, false);
  CHECK(coordinator.number_of({1, 0, "dqn"}) == 5);
  is_there[5] = true;
  is_there[7] = true;  // the coordinator does not know of it yet
  CHECK(coordinator.lost_flights(is_there) == std::vector<experiment::FlightKey>{{0, 1, "min-height"}});
  is_there[2] = true;
  CHECK(coordinator.lost_flights(is_there).empty());
}
