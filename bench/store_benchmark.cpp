// Storing flights durably, as the metrics service does: batches of 64 flights of 100 steps. The floor in the same run
// is one fsync'ed append of as many bytes per batch.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>

#include "common/experiment/statistics.hpp"
#include "common/store/result_store.hpp"

using namespace aloft;

namespace {

constexpr std::uint32_t batch_flights = 64;

flight::FlightRecord flight_of_100_steps() {
  flight::FlightRecord record;
  record.pilots = {"random-walk"};
  record.height_start_m = 40.0;
  for (std::uint32_t step = 1; step <= 100; ++step)
    record.steps.push_back({step,
                            agents::Action::up,
                            -505.0 + 10 * step,
                            3.7,
                            40.0 + step % 20,
                            3,
                            0.31 * step,
                            4.1 + 0.01 * step,
                            4.1 + 0.01 * step,
                            0,
                            {}});
  return record;
}

/// A folder on the disk of the current directory, where results usually go.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::current_path() / "aloft-store-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a scratch folder");
    path = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

void store_flights(benchmark::State& state) {
  const Folder folder;
  const auto experiment =
      experiment::parse(R"({"name": "bench", "trials": 10000000, "world": {}, "agents": ["random-walk"]})", "bench");
  auto results = store::ResultStore::open_for_writing(folder.path / "out", experiment);
  const std::string trace = store::encode_trace(flight_of_100_steps());
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
  const Folder folder;
  const std::string batch(store::encode_trace(flight_of_100_steps()).size() * batch_flights, 'x');
  const int file = ::open((folder.path / "floor").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  for ([[maybe_unused]] auto _ : state) {
    if (::write(file, batch.data(), batch.size()) < 0 || ::fdatasync(file) != 0) state.SkipWithError("cannot write");
  }
  ::close(file);
  state.SetItemsProcessed(state.iterations() * batch_flights);
}
BENCHMARK(append_and_sync)->Unit(benchmark::kMillisecond)->UseRealTime();

void encode_flight(benchmark::State& state) {
  const flight::FlightRecord record = flight_of_100_steps();
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
