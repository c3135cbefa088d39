// Steps per second of one worker of real processes with agents that do not learn, over DDS. All processes of the worker
// share one core; this program, which acts as coordinator and collector, has the others.
// Usage: bus_worker [--benchmark_...]; needs the executables of the services beside it.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/pinned_process.hpp"
#include "common/base/digest.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"

namespace aloft {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t warm_up_flights = 100;
constexpr std::uint64_t collector = 1;  // incarnation under which this program confirms flights
constexpr const char* agents_text = R"(["min-height", "constant-60", "constant-120", "random-walk", "one-step-ahead",
                                        "optimal-height", "planner"])";

std::string measured_experiment(const std::filesystem::path& csv) {
  std::ofstream file(csv);
  file << "step,height_m,throughput_kbps\n";
  for (int step = 1; step <= 100; ++step)
    for (int height = 20; height <= 120; height += 10)
      file << step << ',' << height << ',' << 30000 + (step * 7919 + height * 104729) % 40000 << '\n';
  return R"({"name": "bench", "trials": 100000, "world": {"kind": "measured", "file": ")" + csv.string() +
         R"("}, "agents": )" + agents_text + "}";
}

std::string generated_experiment() {
  return std::string(R"({"name": "bench", "trials": 100000, "world": {"kind": "generated", "bs_density_per_km2": 2.5},
                         "agents": )") +
         agents_text + "}";
}

/// Keeps one worker busy and counts the steps of the flights that it delivers.
class Driver {
 public:
  Driver(const std::string& experiment_text, int number)
      : experiment_(experiment::parse(experiment_text, "the benchmark")),
        place_{.run = "bus-worker-" + std::to_string(getpid()) + "-" + std::to_string(number),
               .worker = "",
               .process = "bus-worker",
               .domain = 10 + static_cast<int>(getpid() % 90)} {
    waiter_.add(records_);
    waiter_.add(statuses_);
    wire::RunControl control;
    control.experiment_id(wire::experiment_id(experiment_.id));
    control.state(wire::RUN_RUNNING);
    control.collector().incarnation(collector);
    control.experiment_json(wire::bytes(experiment_.canonical.dump()));
    controls_.write(control);
    for (const char* program : {"aloft-environment", "aloft-channel", "aloft-baseline-agent"})
      processes_.emplace_back("0", program,
                              std::vector<std::string>{"--run", place_.run, "--worker", "w0", "--domain",
                                                       std::to_string(place_.domain), "--die-with-parent"});
  }

  void fly(std::uint64_t flights) {
    const std::uint64_t until = flights_ + flights;
    const auto limit = Clock::now() + 60s;
    while (flights_ < until) {
      if (Clock::now() > limit) throw std::runtime_error("the worker is stuck");
      waiter_.wait(20ms);
      records_.drain([this](const wire::EpisodeRecord& record) { confirm(record); });
      statuses_.drain([this](const wire::WorkerStatus& status) { lease(status); });
    }
  }

 private:
  void confirm(const wire::EpisodeRecord& record) {
    ++flights_;
    wire::EpisodeStored stored;
    stored.experiment_id(record.experiment_id());
    stored.episode_id(record.episode_id());
    stored.condition(record.condition());
    stored.trial(record.trial());
    stored.agent(record.agent());
    stored.digest(wire::name(sha256_hex(wire::view(record.trace()))));
    stored.collector(collector);
    stored_.write(stored);
  }

  void lease(const wire::WorkerStatus& status) {
    std::set<std::uint64_t> held(status.leases().begin(), status.leases().end());
    std::erase_if(sent_, [&](std::uint64_t id) {
      if (held.contains(id)) seen_.insert(id);
      return seen_.contains(id) && !held.contains(id);
    });
    while (sent_.size() < status.capacity()) {
      wire::TrialAssignment assignment;
      assignment.worker(status.worker());
      assignment.experiment_id(wire::experiment_id(experiment_.id));
      assignment.lease_id(next_);
      assignment.trial(static_cast<std::uint32_t>(next_ - 1));
      assignment.attempt(1);
      for (const agents::AgentSpec& spec : experiment_.agents)
        assignment.agents().push_back(wire::names({spec.name}).front());
      assignments_.write(assignment);
      sent_.push_back(next_++);
    }
  }

  experiment::Experiment experiment_;
  bus::BusOptions place_;
  bus::Participant participant_{place_};
  bus::Writer<wire::RunControl> controls_{participant_};
  bus::Writer<wire::TrialAssignment> assignments_{participant_};
  bus::Writer<wire::EpisodeStored> stored_{participant_};
  bus::Reader<wire::EpisodeRecord> records_{participant_};
  bus::Reader<wire::WorkerStatus> statuses_{participant_};
  bus::Waiter waiter_;
  std::deque<bench::PinnedProcess> processes_;
  std::vector<std::uint64_t> sent_;
  std::set<std::uint64_t> seen_;
  std::uint64_t next_ = 1;
  std::uint64_t flights_ = 0;
};

void measure(benchmark::State& state, const std::string& experiment_text, int number) {
  constexpr std::uint64_t flights = 350;
  constexpr double steps_per_flight = 100.0;
  Driver driver(experiment_text, number);
  driver.fly(warm_up_flights);
  for ([[maybe_unused]] auto _ : state) driver.fly(flights);
  state.counters["steps_per_s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * flights) * steps_per_flight, benchmark::Counter::kIsRate);
}

/// The radio is a table lookup: this measures the exchange of reports and commands.
void worker_measured(benchmark::State& state) {
  const auto csv = std::filesystem::temp_directory_path() / ("bus-worker-" + std::to_string(getpid()) + ".csv");
  measure(state, measured_experiment(csv), 0);
  std::filesystem::remove(csv);
}
BENCHMARK(worker_measured)->Iterations(3)->UseRealTime()->Unit(benchmark::kMillisecond);

/// With the radio computed for 100 generated steps in every trial.
void worker_generated(benchmark::State& state) {
  measure(state, generated_experiment(), 1);
}
BENCHMARK(worker_generated)->Iterations(3)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aloft
