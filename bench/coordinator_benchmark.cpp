// The coordinator and the real database together, with simulated workers that fly in no time: how leases per second,
// memory and the time to resume after a restart grow with the trials and with the workers. The claim: "us per trial" is
// constant.
// Usage: coordinator_benchmark [MOST_TRIALS, a power of ten; default 1000000]. The database of a million flights of 100
// steps takes 4 GB in the current directory's file system, and two minutes.
#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/scene.hpp"
#include "bench/shortest_turn.hpp"
#include "common/base/error.hpp"
#include "common/store/result_store.hpp"
#include "services/coordinator/coordinator.hpp"

namespace {

using namespace aloft;
using coordinator::Clock;
using coordinator::Coordinator;
using namespace std::chrono_literals;

constexpr std::uint32_t trials_at_a_time = 5;  // per worker: its lanes and one more
constexpr std::size_t flights_per_commit = 64;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::size_t heap_bytes() {
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

/// Simulates all workers: each holds its leases, and reports after every flight.
class Fleet {
 public:
  explicit Fleet(std::uint32_t workers) : leases_(workers) {
    for (std::uint32_t i = 0; i < workers; ++i) names_.push_back(fmt::format("w{}", i));
  }

  void report_all(Coordinator& coordinator, Clock::time_point now) {
    for (std::size_t i = 0; i < names_.size(); ++i) report(coordinator, i, now);
  }
  void take(const std::vector<coordinator::Order>& orders) {
    for (const coordinator::Order& order : orders) {
      if (order.cancelled) throw std::logic_error("a lease was taken back");
      const auto worker = static_cast<std::size_t>(std::stoul(order.worker.substr(1)));
      leases_[worker].push_back(order.lease);
      in_the_air_.push_back({worker, order.lease, order.condition, order.trial});
    }
  }
  /// Up to a commit's worth of flights, the oldest first.
  std::vector<experiment::FlightKey> land(std::vector<std::size_t>& by) {
    std::vector<experiment::FlightKey> keys;
    by.clear();
    for (; !in_the_air_.empty() && keys.size() < flights_per_commit; in_the_air_.pop_front()) {
      const Flight& flight = in_the_air_.front();
      keys.push_back({flight.condition, flight.trial, "random-walk"});
      std::erase(leases_[flight.worker], flight.lease);
      by.push_back(flight.worker);
    }
    return keys;
  }
  void report(Coordinator& coordinator, std::size_t worker, Clock::time_point now) {
    coordinator::WorkerNews news;
    news.report = {names_[worker], 1, trials_at_a_time, leases_[worker], {}};
    news.steps_done = steps_ += 100;
    coordinator.on_worker(news, now);
  }

 private:
  struct Flight {
    std::size_t worker;
    std::uint64_t lease;
    std::uint32_t condition;
    std::uint32_t trial;
  };
  std::vector<std::string> names_;
  std::vector<std::vector<std::uint64_t>> leases_;
  std::deque<Flight> in_the_air_;
  std::uint64_t steps_ = 0;
};

struct Row {
  std::uint32_t trials = 0;
  std::uint32_t workers = 0;
  double wall_s = 0.0;
  double coordinator_s = 0.0;  // CPU
  double store_s = 0.0;        // CPU
  double memory_bytes = 0.0;   // of the coordinator
  double open_s = 0.0;         // of the database, by a restarted coordinator
  double read_s = 0.0;         // until its first lease
};

experiment::Experiment experiment_of(std::uint32_t trials) {
  const std::string text = fmt::format(
      R"({{"name": "bench", "trials": {}, "agents": ["random-walk"], "world": {{"kind": "generated",
          "bs_density_per_km2": [1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5, 5.5]}}}})",
      trials / 10);
  return experiment::parse(text, "bench");
}

template <typename Work>
void add_cpu(double& sum_s, Work work) {
  const double start_s = bench::thread_seconds();
  work();
  sum_s += bench::thread_seconds() - start_s;
}

/// A whole sweep: leases, flights, commits, confirmations, until the last flight is stored.
void fly(Row& row, const experiment::Experiment& experiment, store::ResultStore& results, const std::string& trace) {
  const auto heap_before = heap_bytes();
  Clock::time_point now{};
  Coordinator coordinator(experiment, {}, 1, now);
  Fleet fleet(row.workers);
  fleet.report_all(coordinator, now);
  std::vector<std::size_t> by;
  const auto start = Clock::now();
  while (!coordinator.over()) {
    add_cpu(row.coordinator_s, [&] { fleet.take(coordinator.tick(now)); });
    const std::vector<experiment::FlightKey> keys = fleet.land(by);
    add_cpu(row.store_s, [&] {
      results.batch([&] {
        for (const experiment::FlightKey& key : keys) (void)results.add(key, trace);
      });
    });
    add_cpu(row.coordinator_s, [&] {
      for (const experiment::FlightKey& key : keys) coordinator.on_flight_stored(key, now);
      for (const std::size_t worker : by) fleet.report(coordinator, worker, now);
      (void)coordinator.progress(now);
    });
    now += 1ms;
    if (now.time_since_epoch() % 500ms == 0ms) fleet.report_all(coordinator, now);  // heartbeats
  }
  row.wall_s = seconds_since(start);
  row.memory_bytes = static_cast<double>(heap_bytes() - heap_before);
}

/// A coordinator that is started on existing results, up to its first lease if one is left.
void restart(Row& row, const experiment::Experiment& experiment, const std::filesystem::path& folder) {
  const auto start = Clock::now();
  const auto results = store::ResultStore::open_for_reading(folder);
  row.open_s = seconds_since(start);
  Coordinator coordinator(experiment, {}, 1, {});
  results.for_each_flight([&](const store::FlightSummary& flight) { coordinator.resume(flight.key); });
  Fleet(1).report_all(coordinator, {});
  (void)coordinator.tick(Clock::time_point{} + 2s);
  row.read_s = seconds_since(start) - row.open_s;
}

Row measure(std::uint32_t trials, std::uint32_t workers) {
  const bench::Folder folder;
  const experiment::Experiment experiment = experiment_of(trials);
  Row row{trials, workers};
  {
    auto results = store::ResultStore::open_for_writing(folder.path / "out", experiment);
    fly(row, experiment, results, bench::encoded_flight_of_100_steps());
  }
  restart(row, experiment, folder.path / "out");
  return row;
}

void print(const Row& row) {
  const double per_trial_us = 1e6 / row.trials;
  fmt::print("{:>9} {:>8} {:>10.0f} {:>13.2f} {:>8.1f} {:>8.1f} {:>8.1f} {:>9.3f} {:>9.3f} {:>9.2f}\n", row.trials,
             row.workers, row.trials / row.wall_s, row.coordinator_s * per_trial_us, row.store_s * per_trial_us,
             row.wall_s * per_trial_us, row.memory_bytes / row.trials, row.open_s, row.read_s,
             (row.open_s + row.read_s) * per_trial_us);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::err);
  try {
    const unsigned long most = argc > 1 ? std::stoul(argv[1]) : 1'000'000;
    fmt::print("{:>9} {:>8} {:>10} {:>13} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9}\n", "", "", "leases and", "coordinator",
               "store", "wall", "memory", "restart:", "restart:", "restart:");
    fmt::print("{:>9} {:>8} {:>10} {:>13} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9}\n", "trials", "workers", "stores/s",
               "us/trial", "us/trial", "us/trial", "B/trial", "open s", "read s", "us/trial");
    for (std::uint32_t trials = 1000; trials <= most; trials *= 10) print(measure(trials, 1000));
    for (const std::uint32_t workers : {10U, 100U, 10'000U}) print(measure(10'000, workers));
    return exit_ok;
  } catch (const std::exception& error) {
    fmt::print(stderr, "coordinator_benchmark: {}\n", error.what());
    return exit_failure;
  }
}
