// A second collector, coordinator or worker of the same name in a run: it is refused by name, and no run succeeds with
// missing flights.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <signal.h>

#include <catch2/catch.hpp>
#include <memory>
#include <set>
#include <thread>

#include "common/base/digest.hpp"
#include "tests/integration/coordinator_run.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

std::string process(const Command& command) {
  return fmt::format("(process {}, since 20", command.pid());
}

/// A process that confirms flights without being a collector.
class Forger {
 public:
  Forger(const experiment::Experiment& experiment, const CoordinatedRun& run)
      : experiment_(experiment),
        participant_({.run = run.name(), .worker = "", .process = "forger", .domain = std::stoi(test_domain())}) {}

  void claim(const experiment::FlightKey& key, const std::string& digest, std::uint64_t collector) {
    wire::EpisodeStored stored;
    stored.experiment_id(wire::experiment_id(experiment_.id));
    stored.episode_id(experiment::episode_id(experiment_, key));
    stored.condition(key.condition);
    stored.trial(key.trial);
    stored.agent(wire::name(key.agent));
    stored.digest(wire::name(digest));
    stored.collector(collector);
    stored_.write(stored);
  }
  [[nodiscard]] std::size_t listeners() const { return stored_.matched(); }

 private:
  const experiment::Experiment& experiment_;
  bus::Participant participant_;
  bus::Writer<wire::EpisodeStored> stored_{participant_};
};

}  // namespace

TEST_CASE("a second collector of a run is refused by name, and the first can be restarted", "[rivals]") {
  const CoordinatedRun run;
  auto own = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  pump_until_confirmed(worker, 20);
  own->send(SIGSTOP);  // only the second collector could confirm flights now
  const auto second = run.start_in(run.folder("other"), "aloft-metrics");
  worker.behaviour.flights_per_pump = 1;
  pump_until({&worker}, [&] { return !second->running(); });
  const Finished refused = second->wait();
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("run '" + run.name() + "' has one collector") && Contains(process(*own)) &&
                              Contains(run.folder("other").string()) && Contains("refused"));
  CHECK_FALSE(std::filesystem::exists(run.folder("other")));  // a refused collector makes no folder
  CHECK_THAT(run.log("aloft-coordinator"), Contains("refuses aloft-metrics") && Contains(process(*second)));
  own->send(SIGKILL);
  (void)own->wait();
  own = run.start("aloft-metrics");
  pump_until({&worker}, [&] { return !coordinator->running() && !own->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(own->wait().exit_code == 0);
  run.check_results();
}

TEST_CASE("a collector for another folder is refused even if it starts first", "[rivals]") {
  const CoordinatedRun run;
  const auto stranger = run.start_in(run.folder("other"), "aloft-metrics");
  FakeWorker worker = run.worker("w0");
  const auto coordinator = run.start("aloft-coordinator");
  pump_until({&worker}, [&] { return !stranger->running(); });
  const Finished refused = stranger->wait();
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("writes the folder of its coordinator's --out"));
  CHECK(coordinator->running());
  const auto own = run.start("aloft-metrics");
  pump_until({&worker}, [&] { return !coordinator->running() && !own->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  run.check_results();
}

TEST_CASE("flights that only a foreign process confirms are still flown and stored", "[rivals]") {
  const CoordinatedRun run;
  const auto own = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  Forger forger(run.experiment, run);
  pump_until_confirmed(worker, 6);
  pump_until({&worker}, [&] { return forger.listeners() >= 2; });
  // Confirms all flights of the run under its own collector's name, first with wrong, then with right digests.
  for (const auto& key : all_flights(run.experiment)) forger.claim(key, std::string(64, '0'), worker.collector());
  for (const auto& key : all_flights(run.experiment))
    forger.claim(key, sha256_hex(synthetic_trace(run.experiment, key)), worker.collector());
  worker.behaviour.flights_per_pump = 1;
  pump_until(
      {&worker}, [&] { return !coordinator->running() && !own->running(); }, 40s);
  CHECK(coordinator->wait().exit_code == 0);
  CHECK_THAT(run.log("aloft-coordinator"), Contains("this flight is not among the results"));
  run.check_results();
}

TEST_CASE("records that a foreign process confirms while no collector runs are lost, and flown again", "[rivals]") {
  const CoordinatedRun run;
  auto own = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator", {"--claim-timeout", "1"});
  FakeWorker worker = run.worker("w0");
  Forger forger(run.experiment, run);
  pump_until_confirmed(worker, 6);
  pump_until({&worker}, [&] { return forger.listeners() >= 2; });
  own->send(SIGKILL);
  (void)own->wait();
  const std::size_t before = worker.flown().size();
  worker.behaviour.flights_per_pump = 1;
  pump_until({&worker}, [&] { return worker.flown().size() >= before + 6; });
  worker.behaviour.flights_per_pump = 0;
  // With the dead collector's name and the right digests, the worker cannot detect the forgery.
  for (const auto& [key, times] : worker.flown())
    forger.claim(key, sha256_hex(synthetic_trace(run.experiment, key)), worker.collector());
  pump_until({&worker}, [&] { return worker.confirmations() >= before + 6; });
  own = run.start("aloft-metrics");
  worker.behaviour.flights_per_pump = 1;
  pump_until(
      {&worker}, [&] { return !coordinator->running() && !own->running(); }, 40s);
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(times_flown(worker) > static_cast<int>(flights_total));
  run.check_results();
}

TEST_CASE("flights that vanish from the results before the end are named, and the run fails", "[rivals]") {
  const CoordinatedRun run;
  const auto own = run.start("aloft-metrics", {"--summary"});
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  pump_until_confirmed(worker, 30);
  {
    SQLite::Database database((run.results() / "results.sqlite").string(), SQLite::OPEN_READWRITE, 5000);
    // Removes the flight and its count; rows that are merely removed are noticed as damage.
    database.exec(
        "DELETE FROM flight WHERE condition = 0 AND trial = 1 AND agent = 'constant-120';"
        "DELETE FROM trace WHERE flight NOT IN (SELECT id FROM flight);"
        "UPDATE tally SET flights = (SELECT count(*) FROM flight)");
  }
  worker.behaviour.flights_per_pump = 1;
  pump_until({&worker}, [&] { return !coordinator->running() && !own->running(); });
  const std::string missing = "1 of 72 flights are missing: agent constant-120 in trial 1 of condition 0";
  const Finished coordinated = coordinator->wait();
  CHECK(coordinated.exit_code == 1);
  CHECK_THAT(coordinated.err, Contains(missing) && Contains("the same command flies them"));
  CHECK(worker.run_state() == wire::RUN_FAILED);
  CHECK_THAT(worker.run_message(), Contains(missing));
  const Finished collected = own->wait();
  CHECK(collected.exit_code == 1);
  CHECK_THAT(collected.err, Contains(missing) && Contains(run.results().string()));
}

TEST_CASE("a second coordinator of a run ends at once and names the first, which goes on", "[rivals]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  const auto first = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  pump_until_confirmed(worker, 6);
  const auto second = run.start_in(run.folder("other"), "aloft-coordinator");
  const auto same_folder = run.start_in(run.results(), "aloft-coordinator", {}, run.name() + ".x");
  pump_until({&worker}, [&] { return !second->running() && !same_folder->running(); });
  const Finished refused = second->wait();
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("run '" + run.name() + "' has a coordinator already") && Contains(process(*first)) &&
                              Contains("--join"));
  CHECK_FALSE(std::filesystem::exists(run.folder("other")));
  const Finished locked = same_folder->wait();
  CHECK(locked.exit_code == 2);
  CHECK_THAT(locked.err,
             Contains("has a coordinator already") && Contains(process(*first)) && Contains(run.results().string()));
  worker.behaviour.flights_per_pump = 1;
  pump_until({&worker}, [&] { return !first->running() && !metrics->running(); });
  CHECK(first->wait().exit_code == 0);
  CHECK(times_flown(worker) == flights_total);
  CHECK_FALSE(std::filesystem::exists(run.results() / "coordinator.lock"));
  run.check_results();
}

TEST_CASE("of two coordinators that find each other late, the one that started later ends", "[rivals]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  pump_until_confirmed(worker, 6);
  bus::Participant elsewhere({.run = run.name(), .worker = "", .process = "rival", .domain = std::stoi(test_domain())});
  bus::Writer<wire::RunControl> controls(elsewhere);
  wire::RunControl control;
  control.experiment_id(wire::experiment_id(run.experiment.id));
  control.experiment_json(wire::bytes(run.experiment.canonical.dump()));
  control.coordinator().incarnation(99);
  control.coordinator().host(wire::name("elsewhere"));
  control.coordinator().pid(17);
  SECTION("the other one") {
    control.coordinator().since_s(4'000'000'000);  // the year 2096
    control.collector().incarnation(98);
    controls.write(control);
    pump_until({&worker}, [&] {
      return run.log("aloft-coordinator").find("on host elsewhere (process 17, since 2096-") != std::string::npos;
    });
    worker.behaviour.flights_per_pump = 1;
    pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
    CHECK(coordinator->wait().exit_code == 0);
    run.check_results();
  }
  SECTION("this one, and without a word that others would take for the end of the run") {
    control.coordinator().since_s(1);
    controls.write(control);
    pump_until({&worker}, [&] { return !coordinator->running(); });
    const Finished refused = coordinator->wait();
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("aloft-coordinator on host elsewhere (process 17"));
    CHECK(worker.run_state() == wire::RUN_RUNNING);
    CHECK(metrics->running());
  }
}

TEST_CASE("a coordinator that is killed locks its successor neither out of the run nor out of the folder", "[rivals]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  auto coordinator = run.start("aloft-coordinator", {"--look-around", "0.5"});
  FakeWorker worker = run.worker("w0");
  for (std::size_t kill = 1; kill <= 3; ++kill) {
    worker.behaviour.flights_per_pump = 1;
    pump_until_confirmed(worker, 12 * kill);
    coordinator->send(SIGKILL);
    (void)coordinator->wait();
    coordinator = run.start("aloft-coordinator", {"--look-around", "0.5"});
  }
  worker.behaviour.flights_per_pump = 1;
  pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  run.check_results();
}

TEST_CASE("two workers of one name are named and get no trials; the run goes on with the others", "[rivals]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker first = run.worker("w0");
  FakeWorker second = run.worker("w0");
  second.behaviour.incarnation = 2;
  first.behaviour.flights_per_pump = second.behaviour.flights_per_pump = 0;
  const auto both_named = [&] {
    return first.run_message().find("2 workers are called w0: on host test") != std::string::npos;
  };
  pump_until({&first, &second}, both_named);
  FakeWorker other = run.worker("w1");
  pump_until({&first, &second, &other}, [&] { return !coordinator->running() && !metrics->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(times_flown(other) == flights_total);
  CHECK_THAT(run.log("aloft-coordinator"), !Contains("attempt 3"));
  run.check_results();
}
