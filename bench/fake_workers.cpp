// The real coordinator and the real collector over DDS, with workers that fly in no time, all simulated by this
// process: trials per second from lease to confirmation, and the CPU time per trial of the two.
// Usage: fake_workers [WORKERS ...; default 10 100 1000]; needs the executables of the services beside it.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bench/pinned_process.hpp"
#include "bench/scene.hpp"
#include "common/base/error.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"
#include "common/store/result_store.hpp"

namespace {

using namespace aloft;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t warm_up_trials = 3'000;
constexpr std::uint64_t measured_trials = 15'000;
constexpr std::uint32_t trials_at_a_time = 5;
constexpr std::size_t most_unconfirmed = 256;  // half of the writer's history
constexpr auto send_again_after = 2s;
constexpr auto heartbeat_period = 500ms;
constexpr auto limit = 120s;

/// CPU time of another process.
double cpu_seconds(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string word;
  std::getline(file, word, ')');
  for (int field = 3; field <= 13; ++field) file >> word;
  double user = 0.0;
  double system = 0.0;
  file >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class Fleet {
 public:
  Fleet(const experiment::Experiment& experiment, const bus::BusOptions& place, std::uint32_t workers)
      : experiment_(experiment), participant_(place), trace_(bench::encoded_flight_of_100_steps()) {
    waiter_.add(assignments_);
    waiter_.add(stored_);
    for (std::uint32_t i = 0; i < workers; ++i) workers_[fmt::format("w{}", i)];
  }

  void fly_until(std::uint64_t trials) {
    const auto deadline = Clock::now() + limit;
    while (trials_ < trials) {
      waiter_.wait(10ms);
      now_ = Clock::now();
      if (now_ > deadline) throw std::runtime_error(fmt::format("{} trials after {} s", trials_, limit.count()));
      assignments_.drain([this](const wire::TrialAssignment& assignment) { take(assignment); });
      stored_.drain([this](const wire::EpisodeStored& stored) { confirm(stored.episode_id()); });
      send();
      for (auto& [name, worker] : workers_)
        if (worker.changed || now_ >= worker.beat_at) report(name, worker);
    }
  }

 private:
  struct Worker {
    std::set<std::uint64_t> leases;
    bool changed = true;
    Clock::time_point beat_at;
  };
  struct Flight {
    std::string worker;
    std::uint64_t lease;
    std::uint32_t condition;
    std::uint32_t trial;
    Clock::time_point sent;
  };

  void take(const wire::TrialAssignment& assignment) {
    const std::string name(wire::view(assignment.worker()));
    Worker& worker = workers_.at(name);
    worker.changed = true;
    if (assignment.cancelled()) {
      worker.leases.erase(assignment.lease_id());
      return;
    }
    if (!worker.leases.insert(assignment.lease_id()).second) return;
    to_fly_.push_back({name, assignment.lease_id(), assignment.condition(), assignment.trial(), {}});
  }

  void confirm(std::uint64_t episode) {
    const auto at = unconfirmed_.find(episode);
    if (at == unconfirmed_.end()) return;
    Worker& worker = workers_.at(at->second.worker);
    worker.leases.erase(at->second.lease);
    worker.changed = true;
    unconfirmed_.erase(at);
    ++trials_;
  }

  void send() {
    for (; !to_fly_.empty() && unconfirmed_.size() < most_unconfirmed; to_fly_.pop_front()) {
      const Flight& flight = to_fly_.front();
      const std::uint64_t episode =
          experiment::episode_id(experiment_, {flight.condition, flight.trial, "random-walk"});
      write(episode, unconfirmed_.insert_or_assign(episode, flight).first->second);
    }
    for (auto& [episode, flight] : unconfirmed_)
      if (now_ - flight.sent > send_again_after) write(episode, flight);
  }

  void write(std::uint64_t episode, Flight& flight) {
    wire::EpisodeRecord record;
    record.experiment_id(wire::experiment_id(experiment_.id));
    record.episode_id(episode);
    record.condition(flight.condition);
    record.trial(flight.trial);
    record.agent(wire::name("random-walk"));
    record.worker(wire::name(flight.worker));
    record.lease_id(flight.lease);
    record.trace(wire::bytes(trace_));
    records_.write(record);
    flight.sent = now_;
  }

  void report(const std::string& name, Worker& worker) {
    wire::WorkerStatus status;
    status.worker(wire::name(name));
    status.experiment_id(wire::experiment_id(experiment_.id));
    status.host(wire::name("bench"));
    status.pid(static_cast<std::uint32_t>(getpid()));
    status.incarnation(1);
    status.heartbeat(++heartbeat_);
    status.capacity(trials_at_a_time);
    status.leases().assign(worker.leases.begin(), worker.leases.end());
    status.steps_done(100 * trials_);
    statuses_.write(status);
    worker.changed = false;
    worker.beat_at = now_ + heartbeat_period;
  }

  const experiment::Experiment& experiment_;
  bus::Participant participant_;
  bus::Writer<wire::WorkerStatus> statuses_{participant_};
  bus::Writer<wire::EpisodeRecord> records_{participant_};
  bus::Reader<wire::TrialAssignment> assignments_{participant_};
  bus::Reader<wire::EpisodeStored> stored_{participant_};
  bus::Waiter waiter_;
  std::string trace_;
  std::map<std::string, Worker> workers_;
  std::deque<Flight> to_fly_;
  std::map<std::uint64_t, Flight> unconfirmed_;
  Clock::time_point now_;
  std::uint64_t heartbeat_ = 0;
  std::uint64_t trials_ = 0;
};

void measure(std::uint32_t workers) {
  const bench::Folder folder;
  const std::string text = R"({"name": "bench", "trials": 1000000, "agents": ["random-walk"],
                               "world": {"kind": "generated", "bs_density_per_km2": 1}})";
  const experiment::Experiment experiment = experiment::parse(text, "bench");
  const bus::BusOptions place{.run = fmt::format("fake-{}-{}", getpid(), workers),
                              .worker = "",
                              .process = "fake-workers",
                              .domain = 10 + static_cast<int>(getpid() % 90)};
  const std::string file = (folder.path / "bench.json").string();
  std::ofstream(file) << experiment.canonical.dump();
  const std::vector<std::string> arguments{"--experiment",
                                           file,
                                           "--results",
                                           (folder.path / "out").string(),
                                           "--run",
                                           place.run,
                                           "--domain",
                                           std::to_string(place.domain),
                                           "--die-with-parent"};
  const std::string all_cores = fmt::format("0-{}", sysconf(_SC_NPROCESSORS_CONF) - 1);
  const std::string log = (folder.path / "log").string();
  const bench::PinnedProcess metrics(all_cores, "aloft-metrics", arguments, log);
  const bench::PinnedProcess coordinator(all_cores, "aloft-coordinator", arguments, log);
  Fleet fleet(experiment, place, workers);
  fleet.fly_until(warm_up_trials);
  const double coordinator_s = cpu_seconds(coordinator.pid());
  const double metrics_s = cpu_seconds(metrics.pid());
  const auto start = Clock::now();
  fleet.fly_until(warm_up_trials + measured_trials);
  const double wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  constexpr double per_trial_us = 1e6 / static_cast<double>(measured_trials);
  fmt::print("{:>8} {:>10.0f} {:>14.1f} {:>14.1f}\n", workers, measured_trials / wall_s,
             (cpu_seconds(coordinator.pid()) - coordinator_s) * per_trial_us,
             (cpu_seconds(metrics.pid()) - metrics_s) * per_trial_us);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::err);
  try {
    std::vector<std::uint32_t> fleets;
    for (int i = 1; i < argc; ++i) fleets.push_back(static_cast<std::uint32_t>(std::stoul(argv[i])));
    if (fleets.empty()) fleets = {10, 100, 1000};
    fmt::print("{:>8} {:>10} {:>14} {:>14}\n", "workers", "trials/s", "coordinator us", "collector us");
    for (const std::uint32_t workers : fleets) measure(workers);
    return exit_ok;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fake_workers: {}\n", error.what());
    return exit_failure;
  }
}
