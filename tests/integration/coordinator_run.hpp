#pragma once

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/command.hpp"
#include "tests/integration/coordinator_fake_worker.hpp"

namespace aloft::test {

inline constexpr const char* coordination_text = R"({
  "name": "coordination", "seed": 7, "trials": 12, "max_attempts": 2,
  "world": {"kind": "generated", "bs_density_per_km2": [1, 5]},
  "agents": ["min-height", "constant-120", "random-walk"]
})";
inline constexpr std::size_t flights_total = 2 * 12 * 3;

/// A run with its own name and domain: result folder, processes, workers.
class CoordinatedRun {
 public:
  CoordinatedRun() {
    static int runs = 0;
    name_ = "coordination-" + std::to_string(getpid()) + "-" + std::to_string(++runs);
    write_text(scratch_ / "experiment.json", experiment.canonical.dump());
  }

  const experiment::Experiment experiment = experiment::parse(coordination_text, "test");

  [[nodiscard]] std::filesystem::path results() const { return scratch_ / "results"; }
  [[nodiscard]] std::filesystem::path folder(const std::string& name) const { return scratch_ / name; }
  [[nodiscard]] const std::string& name() const { return name_; }

  std::unique_ptr<Command> start(const std::string& program, const std::vector<std::string>& more = {}) const {
    return start_in(results(), program, more);
  }
  /// Starts a program with another result folder and its own log.
  std::unique_ptr<Command> start_in(const std::filesystem::path& folder, const std::string& program,
                                    const std::vector<std::string>& more = {}, const std::string& run = "") const {
    std::vector<std::string> arguments{program,
                                       "--run",
                                       run.empty() ? name_ : run,
                                       "--domain",
                                       test_domain(),
                                       "--log-dir",
                                       (folder == results() ? scratch_ / "log" : scratch_ / "log-of-others").string(),
                                       "--results",
                                       folder.string(),
                                       "--experiment",
                                       (scratch_ / "experiment.json").string()};
    if (program == "aloft-coordinator" && std::find(more.begin(), more.end(), "--look-around") == more.end())
      arguments.insert(arguments.end(), {"--look-around", "0"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Command>(arguments);
  }

  [[nodiscard]] FakeWorker worker(const std::string& name) const {
    return FakeWorker(experiment, name_, std::stoi(test_domain()), name);
  }

  [[nodiscard]] bus::BusOptions place(const std::string& process) const {
    return {.run = name_, .worker = "", .process = process, .domain = std::stoi(test_domain())};
  }

  [[nodiscard]] std::string log(const std::string& program) const {
    return read_text(scratch_ / "log" / (program + ".log"));
  }

  /// The digest that the results must have, computed without starting a process.
  [[nodiscard]] std::string expected_digest() const {
    auto store = store::ResultStore::open_for_writing(scratch_ / "expected", experiment);
    store.batch([&] {
      for (const auto& key : all_flights(experiment)) store.add(key, synthetic_trace(experiment, key));
    });
    return store.digest();
  }

  void check_results() const {
    const auto store = store::ResultStore::open_for_reading(results());
    CHECK(store.keys().size() == flights_total);
    CHECK(store.digest() == expected_digest());
  }

 private:
  ScratchDir scratch_;
  std::string name_;
};

template <class Condition>
void pump_until(std::vector<FakeWorker*> workers, const Condition& done,
                std::chrono::seconds limit = std::chrono::seconds(20)) {
  limit *= slowdown;
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) FAIL("not done after " << limit.count() << " s");
    for (FakeWorker* worker : workers) worker->pump();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (FakeWorker* worker : workers) worker->pump();  // the last samples
}

/// Flies no more than `flights`, so that the run cannot end while the confirmations are on their way.
inline void pump_until_confirmed(FakeWorker& worker, std::size_t flights) {
  pump_until({&worker}, [&] {
    if (worker.flown().size() >= flights) worker.behaviour.flights_per_pump = 0;
    return worker.confirmations() >= flights;
  });
}

[[nodiscard]] inline int times_flown(const FakeWorker& worker) {
  int flights = 0;
  for (const auto& [key, times] : worker.flown()) flights += times;
  return flights;
}

}  // namespace aloft::test
