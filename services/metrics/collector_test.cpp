#include "services/metrics/collector.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::metrics;
using namespace std::chrono_literals;

namespace {

const Clock::time_point start{};

experiment::Experiment small_experiment() {
  experiment::Experiment experiment;
  experiment.name = "small";
  experiment.id = "0123456789abcdef";
  experiment.trials = 100;
  experiment.conditions.resize(2);
  for (const char* name : {"min-height", "constant-120"}) experiment.agents.push_back({name, name, {}, {}});
  return experiment;
}

flight::FlightRecord flight_of(double height_m) {
  flight::FlightRecord flight;
  flight.pilots = {"min-height"};
  flight.height_start_m = 40.0;
  for (std::uint32_t step = 1; step <= 3; ++step) {
    flight::StepRecord record;
    record.step = step;
    record.action = agents::Action::hold;
    record.height_m = height_m;
    record.qos = 5.0 + step;
    record.reward = record.qos;
    flight.steps.push_back(record);
  }
  return flight;
}

/// A database in memory that can fail.
struct FakeStore {
  std::map<experiment::FlightKey, std::string> flights;
  std::vector<std::size_t> batches;
  std::function<void()> before_commit = [] {};

  std::vector<store::Stored> commit(const std::vector<Record>& records) {
    before_commit();
    batches.push_back(records.size());
    std::vector<store::Stored> stored;
    for (const Record& record : records) {
      const auto [at, added] = flights.emplace(record.key, record.trace);
      if (!added && at->second != record.trace) throw IntegrityError("flown twice with different results");
      stored.push_back(added ? store::Stored::added : store::Stored::already_there);
    }
    return stored;
  }
};

struct Fixture {
  experiment::Experiment experiment = small_experiment();
  Instruments instruments;
  FakeStore store;
  Collector collector{experiment, [this](const auto& records) { return store.commit(records); }, instruments};

  [[nodiscard]] Record record(std::uint32_t trial, const flight::FlightRecord& flight = flight_of(50.0)) const {
    Record record;
    record.experiment_id = experiment.id;
    record.key = {0, trial, "min-height"};
    record.episode_id = experiment::episode_id(experiment, record.key);
    record.worker = "w0";
    record.trace = store::encode_trace(flight);
    return record;
  }
};

}  // namespace

TEST_CASE_METHOD(Fixture, "records are committed 50 ms after the first, or 64 at a time", "[collector]") {
  CHECK_FALSE(collector.next_due());
  CHECK_FALSE(collector.offer(record(0), start));
  CHECK_FALSE(collector.offer(record(1), start + 30ms));
  CHECK(collector.next_due() == start + 50ms);
  CHECK(collector.commit_due(start + 49ms).empty());
  const auto done = collector.commit_due(start + 50ms);
  REQUIRE(done.size() == 2);
  CHECK(done[1].key == record(1).key);
  CHECK(done[1].episode_id == record(1).episode_id);
  CHECK(done[1].digest == sha256_hex(record(1).trace));
  CHECK(done[1].is_new);
  CHECK_FALSE(collector.next_due());

  for (std::uint32_t trial = 2; trial < 66; ++trial) collector.offer(record(trial), start + 1s);
  CHECK(collector.commit_due(start + 1s).size() == 64);
  CHECK(store.batches == std::vector<std::size_t>{2, 64});
  CHECK_THAT(instruments.prometheus_text(),
             Catch::Contains("aloft_flights_stored_total 66\n") && Catch::Contains("aloft_steps_stored_total 198\n"));
}

TEST_CASE_METHOD(Fixture, "only the flights of agents that remember earlier flights have a memory", "[collector]") {
  experiment.agents.push_back(agents::parse_agents({{"type", "dqn"}, {"memory", "lifelong"}}, "agents[2]").at(0));
  Record flight = record(0);
  flight.memory = "memory";
  CHECK_THAT(collector.offer(flight, start).value_or(""), Catch::Contains("has no memory to keep"));
  flight.key.agent = "dqn";
  flight.episode_id = experiment::episode_id(experiment, flight.key);
  CHECK_FALSE(collector.offer(flight, start));
  flight.memory.clear();
  CHECK_THAT(collector.offer(flight, start).value_or(""), Catch::Contains("memory is missing"));
}

TEST_CASE_METHOD(Fixture, "a duplicate is confirmed again and stored once", "[collector]") {
  collector.offer(record(0), start);
  collector.offer(record(0), start);  // in the same batch
  CHECK(collector.commit_due(start, true).size() == 1);
  collector.offer(record(0), start + 2s);
  const auto again = collector.commit_due(start + 2s, true);
  REQUIRE(again.size() == 1);
  CHECK_FALSE(again[0].is_new);
  CHECK(store.flights.size() == 1);
  CHECK_THAT(instruments.prometheus_text(),
             Catch::Contains("aloft_records_duplicate_total 1\n") && Catch::Contains("aloft_flights_stored_total 1\n"));
}

TEST_CASE_METHOD(Fixture, "a flight with two results stops the collector", "[collector]") {
  collector.offer(record(0), start);
  collector.commit_due(start, true);
  collector.offer(record(0, flight_of(60.0)), start);
  CHECK_THROWS_AS(collector.commit_due(start, true), IntegrityError);
}

TEST_CASE_METHOD(Fixture, "a full disk pauses, and loses nothing", "[collector]") {
  store.before_commit = [] { throw std::runtime_error("disk full"); };
  collector.offer(record(0), start);
  CHECK(collector.commit_due(start + 50ms).empty());
  CHECK_THAT(collector.paused_because(), Catch::Contains("disk full"));
  CHECK(collector.next_due() == start + 1050ms);
  collector.offer(record(1), start + 100ms);
  CHECK(collector.commit_due(start + 1049ms).empty());
  store.before_commit = [] {};
  CHECK(collector.commit_due(start + 1050ms).size() == 2);
  CHECK(collector.paused_because().empty());
  CHECK(store.flights.size() == 2);
}

TEST_CASE_METHOD(Fixture, "while it is paused, its memory is bounded", "[collector]") {
  CollectorOptions options;
  options.queue_bytes = 3 * record(0).trace.size();
  Collector bounded(
      experiment, [this](const auto& records) { return store.commit(records); }, instruments, options);
  for (std::uint32_t trial = 0; trial < 10; ++trial) CHECK_FALSE(bounded.offer(record(trial), start));
  CHECK(bounded.queued() == 3);
  CHECK(bounded.commit_due(start, true).size() == 3);  // the others were not confirmed: they come again
}

TEST_CASE_METHOD(Fixture, "wrong records are refused with the reason", "[collector]") {
  const auto refused = [this](Record wrong) { return collector.offer(std::move(wrong), start).value_or("accepted"); };
  Record wrong = record(0);
  wrong.experiment_id = "fedcba9876543210";
  CHECK_THAT(refused(wrong), Catch::Contains("worker 'w0'") && Catch::Contains("experiment 'fedcba9876543210'"));
  wrong = record(0);
  wrong.key.condition = 2;
  CHECK_THAT(refused(wrong), Catch::Contains("2 conditions of 100 trials"));
  wrong = record(0);
  wrong.key.trial = 100;
  CHECK_THAT(refused(wrong), Catch::Contains("2 conditions of 100 trials"));
  wrong = record(0);
  wrong.key.agent = "planner";
  CHECK_THAT(refused(wrong), Catch::Contains("no such agent"));
  wrong = record(0);
  wrong.key.trial = 1;
  CHECK_THAT(refused(wrong), Catch::Contains("episode id"));
  wrong = record(0);
  wrong.trace = "no trace at all";
  CHECK_THAT(refused(wrong), Catch::Contains("trace"));
  CHECK_THAT(refused(record(0, {})), Catch::Contains("0 steps"));
  CHECK(collector.queued() == 0);
  CHECK_THAT(instruments.prometheus_text(),
             Catch::Contains("reason=\"other_experiment\"} 1\n") && Catch::Contains("reason=\"unknown_flight\"} 4\n"));
}

TEST_CASE_METHOD(Fixture, "impossible numbers are refused", "[collector]") {
  const auto refused = [this](const std::function<void(flight::FlightRecord&)>& spoil) {
    flight::FlightRecord flight = flight_of(50.0);
    spoil(flight);
    return collector.offer(record(0, flight), start).has_value();
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(refused([](auto&) {}));
  CHECK(refused([](auto& flight) { flight.steps[1].qos = nan; }));
  CHECK(refused([](auto& flight) { flight.steps[1].qos = -1.0; }));
  CHECK(refused([](auto& flight) { flight.steps[1].height_m = nan; }));
  CHECK(refused([](auto& flight) { flight.steps[1].x_m = 1e9; }));
  CHECK(refused([](auto& flight) { flight.steps[1].reward = std::numeric_limits<double>::infinity(); }));
  CHECK(refused([](auto& flight) { flight.steps[1].step = 7; }));
  CHECK(refused([](auto& flight) { flight.pilots.clear(); }));
}
