// The coordinator's ledger alone, with 1,000 workers that answer at once: how the cost of a lease, of a trial's memory
// and of a restart grow with the number of trials. The claim: the "per trial" column is constant.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "services/coordinator/lease_ledger.hpp"

namespace {

using namespace aloft::coordinator;
using namespace std::chrono_literals;

constexpr std::uint32_t agents = 8;
constexpr std::uint32_t workers = 1000;
constexpr std::uint32_t capacity = 2;

LedgerOptions options(std::uint32_t trials) {
  LedgerOptions options;
  options.conditions = 10;
  options.trials = trials / 10;
  options.agents = agents;
  return options;
}

/// A whole sweep: every worker holds two trials, reports its flights one by one, and sends two heartbeats a second.
void lease_and_store(benchmark::State& state) {
  const auto trials = static_cast<std::uint32_t>(state.range(0));
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < workers; ++i) names.push_back("worker-" + std::to_string(i));
  std::size_t bytes = 0;
  for ([[maybe_unused]] auto _ : state) {
    LeaseLedger ledger(options(trials));
    Clock::time_point now{};
    std::vector<Lease> in_air;
    std::size_t oldest = 0;
    std::uint64_t heartbeats = 0;
    const auto beat = [&](const std::string& name) { ledger.heartbeat({name, 1, capacity, {}}, now); };
    for (const std::string& name : names) beat(name);
    while (!ledger.finished()) {
      for (Lease lease; ledger.grant(now, lease);) in_air.push_back(std::move(lease));
      const Lease& lease = in_air[oldest++];
      for (const std::uint32_t agent : lease.agents) ledger.flight_stored(lease.condition, lease.trial, agent);
      beat(names[heartbeats++ % workers]);
      now += 1us;
      if (oldest == std::size_t{4} * workers) {  // forget what is done, as the bus does
        in_air.erase(in_air.begin(), in_air.begin() + 4L * workers);
        oldest = 0;
      }
    }
    bytes = ledger.memory_bytes();
  }
  state.counters["leases_per_s"] =
      benchmark::Counter(static_cast<double>(trials), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["per_trial"] = benchmark::Counter(
      static_cast<double>(trials), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["bytes_per_trial"] = static_cast<double>(bytes) / trials;
}

/// A restarted coordinator with half of the flights in the database: from nothing to the first lease.
void recover(benchmark::State& state) {
  const auto trials = static_cast<std::uint32_t>(state.range(0));
  for ([[maybe_unused]] auto _ : state) {
    LeaseLedger ledger(options(trials));
    for (std::uint32_t condition = 0; condition < 5; ++condition)
      for (std::uint32_t trial = 0; trial < trials / 10; ++trial)
        for (std::uint32_t agent = 0; agent < agents; ++agent) ledger.flight_stored(condition, trial, agent);
    ledger.heartbeat({"w0", 1, 1, {}}, {});
    Lease lease;
    benchmark::DoNotOptimize(ledger.grant({}, lease));
  }
  state.counters["per_trial"] = benchmark::Counter(
      static_cast<double>(trials), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// All workers are lost at once: from the loss until other workers hold all leases.
void lose_all_workers(benchmark::State& state) {
  const auto lost_workers = static_cast<std::uint32_t>(state.range(0));
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    LeaseLedger ledger(options(100'000));
    for (std::uint32_t i = 0; i < lost_workers; ++i)
      ledger.heartbeat({"old-" + std::to_string(i), 1, capacity, {}}, {});
    Lease lease;
    while (ledger.grant({}, lease)) {
    }
    const Clock::time_point later{10s};
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < lost_workers; ++i) names.push_back("new-" + std::to_string(i));
    state.ResumeTiming();
    benchmark::DoNotOptimize(ledger.expire(later));
    for (const std::string& name : names) ledger.heartbeat({name, 1, capacity, {}}, later);
    while (ledger.grant(later, lease)) {
    }
  }
  state.counters["per_worker"] = benchmark::Counter(
      static_cast<double>(lost_workers), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(lease_and_store)->Arg(1'000)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recover)->Arg(1'000)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(lose_all_workers)->Arg(10)->Arg(100)->Arg(1'000)->Unit(benchmark::kMicrosecond);

}  // namespace
