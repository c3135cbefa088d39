// Storing flights durably, as the metrics service does: batches of 64 flights of 100 steps. The floor in the same run
// is one fsync'ed append of the same number of bytes per batch.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <numeric>

#include "bench/scene.hpp"
#include "common/experiment/statistics.hpp"
#include "common/store/result_store.hpp"

using namespace aloft;

namespace {

constexpr std::uint32_t batch_flights = 64;

void store_flights(benchmark::State& state) {
  const bench::Folder folder;
  const auto experiment =
      experiment::parse(R"({"name": "bench", "trials": 10000000, "world": {}, "agents": ["random-walk"]})", "bench");
  auto results = store::ResultStore::open_for_writing(folder.path / "out", experiment);
  const std::string trace = bench::encoded_flight_of_100_steps();
  std::uint32_t trial = 0;
  for ([[maybe_unused]] auto _ : state)
    results.batch([&] {
      for (std::uint32_t i = 0; i < batch_flights; ++i) (void)results.add({0, trial++, "random-walk"}, trace);
    });
  state.SetItemsProcessed(state.iterations() * batch_flights);
  state.counters["bytes_per_trace"] = static_cast<double>(trace.size());
}
BENCHMARK(store_flights)->Unit(benchmark::kMillisecond)->UseRealTime();

void append_and_sync(benchmark::State& state) {
  const bench::Folder folder;
  const std::string batch(bench::encoded_flight_of_100_steps().size() * batch_flights, 'x');
  const int file = ::open((folder.path / "floor").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  for ([[maybe_unused]] auto _ : state) {
    if (::write(file, batch.data(), batch.size()) < 0 || ::fdatasync(file) != 0) state.SkipWithError("cannot write");
  }
  ::close(file);
  state.SetItemsProcessed(state.iterations() * batch_flights);
}
BENCHMARK(append_and_sync)->Unit(benchmark::kMillisecond)->UseRealTime();

void encode_flight(benchmark::State& state) {
  const flight::FlightRecord record = store::decode_trace(bench::encoded_flight_of_100_steps());
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(store::encode_trace(record));
}
BENCHMARK(encode_flight)->Unit(benchmark::kMicrosecond);

/// All intervals of a condition of 1,000 trials and 8 agents: 8 means and 8 gains.
void intervals_of_condition(benchmark::State& state) {
  std::vector<std::vector<double>> samples(16, std::vector<double>(1000));
  for (auto& sample : samples) std::iota(sample.begin(), sample.end(), 0.0);
  const std::vector<std::span<const double>> views(samples.begin(), samples.end());
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(experiment::bootstrap_ci95(views, 1));
}
BENCHMARK(intervals_of_condition)->Unit(benchmark::kMillisecond);

}  // namespace
