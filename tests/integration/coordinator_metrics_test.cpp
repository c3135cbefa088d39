// The real coordinator and the real collector over DDS; the test simulates the workers.
#include <httplib.h>
#include <signal.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <thread>

#include "common/base/random.hpp"
#include "tests/faults/effort.hpp"
#include "tests/integration/coordinator_run.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

/// The answer of the collector's HTTP server; its port is read from the log.
std::optional<std::string> http_get(const CoordinatedRun& run, const std::string& path) {
  std::smatch found;
  const std::string log = run.log("aloft-metrics");
  if (!std::regex_search(log, found, std::regex("http://127.0.0.1:([0-9]+)/"))) return std::nullopt;
  httplib::Client client("127.0.0.1", std::stoi(found[1]));
  const auto answer = client.Get(path);
  return answer && answer->status == 200 ? std::optional(answer->body) : std::nullopt;
}

}  // namespace

TEST_CASE("the experiment is offered repeatedly, because a foreign offer can displace one", "[coordinator]") {
  const CoordinatedRun run;
  const bus::Participant observer(run.place("observer"));
  bus::Reader<wire::RunControl> controls(observer);
  const auto coordinator = run.start("aloft-coordinator");
  int offers = 0;
  pump_until(
      {},
      [&] {
        controls.drain([&](const wire::RunControl& control) {
          CHECK(experiment::parse(wire::view(control.experiment_json()), "offer").id == run.experiment.id);
          ++offers;
        });
        return offers >= 3;
      },
      60s);
}

TEST_CASE("two workers, every record twice, one of another experiment: all flights once", "[coordinator][metrics]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics", {"--http-port", "0"});
  const auto coordinator = run.start("aloft-coordinator", {"--trial-order", "shuffled"});
  FakeWorker w0 = run.worker("w0");
  FakeWorker w1 = run.worker("w1");
  w0.behaviour.duplicates = true;
  std::string http_metrics;
  std::string http_status;
  pump_until({&w0, &w1}, [&] {
    const bool half_flown = w0.flown().size() + w1.flown().size() > flights_total / 2;
    const bool half_stored = w0.confirmations() > flights_total / 2;
    // The last flights wait until the collector was asked, because it ends with the run.
    w0.behaviour.flights_per_pump = w1.behaviour.flights_per_pump = half_flown && http_metrics.empty() ? 0 : 1;
    if (half_stored && http_metrics.empty()) {
      w0.send({0, 0, "min-height"}, "rubbish", "0000000000000000");
      http_metrics = http_get(run, "/metrics").value_or("no answer");
      http_status = http_get(run, "/status").value_or("no answer");
      CHECK(http_get(run, "/healthz") == "ok\n");
    }
    return !coordinator->running() && !metrics->running();
  });
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(metrics->wait().exit_code == 0);
  CHECK(w0.run_state() == wire::RUN_FINISHED);
  CHECK(times_flown(w0) + times_flown(w1) == flights_total);
  CHECK(times_flown(w0) > 0);
  CHECK(times_flown(w1) > 0);
  CHECK_THAT(http_metrics, Contains("aloft_flights_stored_total") && Contains("aloft_flights_total 72\n"));
  CHECK_THAT(http_status, Contains("\"flights_total\": 72") && Contains("\"worker\": \"w1\""));
  run.check_results();
}

TEST_CASE("coordinator and collector are killed again and again: the same results", "[coordinator][metrics]") {
  const CoordinatedRun run;
  auto metrics = run.start("aloft-metrics");
  auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  RandomStream random(static_cast<std::uint64_t>(getpid()), 0, "kills");
  INFO("seed " << getpid());
  int kills = 0;
  std::size_t kill_at = 3;
  pump_until(
      {&worker},
      [&] {
        if (kills < 6 && worker.flown().size() >= kill_at) {
          auto& victim = kills % 2 == 0 ? metrics : coordinator;
          victim->send(SIGKILL);
          (void)victim->wait();
          victim = run.start(kills % 2 == 0 ? "aloft-metrics" : "aloft-coordinator");
          kill_at = worker.flown().size() + 3 + random.uniform_index(6);
          ++kills;
        }
        return !coordinator->running();
      },
      40s);
  CHECK(kills == 6);
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(metrics->wait().exit_code == 0);
  // A restarted coordinator takes over trials in the air; only those that no worker reported are flown twice.
  CHECK(times_flown(worker) <= static_cast<int>(flights_total) + 3 * 2 * 3);
  run.check_results();
}

TEST_CASE("killed at any moment, coordinator and collector go on; at most one trial per worker is flown again",
          "[coordinator][metrics]") {
  const int moments = effort(4, 50);
  for (const char* victim : {"aloft-coordinator", "aloft-metrics"})
    for (int moment = 0; moment < moments; ++moment) {
      const CoordinatedRun run;
      std::map<std::string, std::unique_ptr<Command>> processes;
      for (const char* program : {"aloft-metrics", "aloft-coordinator"}) processes[program] = run.start(program);
      FakeWorker w0 = run.worker("w0");
      FakeWorker w1 = run.worker("w1");
      w0.behaviour.capacity = w1.behaviour.capacity = 1;
      const auto kill_at = 1 + static_cast<int>(flights_total - 2) * moment / moments;
      INFO(victim << " is killed after " << kill_at << " of " << flights_total << " flights");
      bool killed = false;
      pump_until({&w0, &w1}, [&] {
        if (!killed && times_flown(w0) + times_flown(w1) >= kill_at) {
          processes[victim]->send(SIGKILL);
          (void)processes[victim]->wait();
          processes[victim] = run.start(victim);
          killed = true;
        }
        return !processes["aloft-coordinator"]->running() && !processes["aloft-metrics"]->running();
      });
      CHECK(killed);
      for (const auto& [program, process] : processes) CHECK(process->wait().exit_code == 0);
      constexpr int flights_per_trial = 3;
      CHECK(times_flown(w0) + times_flown(w1) <= static_cast<int>(flights_total) + 2 * flights_per_trial);
      run.check_results();
    }
}

TEST_CASE("a silent worker's trials go to another; its late results do no harm", "[coordinator]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator", {"--heartbeat-timeout", "0.6"});
  FakeWorker w0 = run.worker("w0");
  FakeWorker w1 = run.worker("w1");
  w0.behaviour.flights_per_pump = 0;
  pump_until({&w0}, [&] { return w0.leases() == 2; });
  w0.behaviour.silent = true;
  w0.behaviour.flights_per_pump = 1;
  pump_until({&w1}, [&] { return w1.flown().size() == flights_total - 3; });  // all but the last trial
  CHECK_THAT(run.log("aloft-coordinator"), Contains("worker w0 has been silent"));
  w0.behaviour.silent = false;
  pump_until({&w0, &w1}, [&] { return !coordinator->running() && !metrics->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(w1.flown().count({0, 0, "min-height"}) == 1);
  run.check_results();
}

TEST_CASE("a trial that fails on every worker is reported after the rest is done", "[coordinator]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  FakeWorker worker = run.worker("w0");
  worker.behaviour.failing = {{1, 3}};
  SECTION("the rest goes on") {
    const auto coordinator = run.start("aloft-coordinator");
    pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
    const Finished finished = coordinator->wait();
    CHECK(finished.exit_code == 1);
    CHECK_THAT(finished.err, Contains("trial 3 of condition 1") && Contains("made to fail") &&
                                 Contains("69 of 72 flights stored, 1 trials failed"));
    CHECK(worker.run_state() == wire::RUN_FAILED);
    CHECK_THAT(worker.run_message(), Contains("trial 3 of condition 1"));
    CHECK(store::ResultStore::open_for_reading(run.results()).keys().size() == flights_total - 3);
  }
  SECTION("with --fail-fast 1 it does not") {
    worker.behaviour.failing = {{0, 1}};
    const auto coordinator = run.start("aloft-coordinator", {"--fail-fast", "1"});
    pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
    CHECK(coordinator->wait().exit_code == 1);
    CHECK(store::ResultStore::open_for_reading(run.results()).keys().size() < flights_total - 3);
  }
}

TEST_CASE("a record that can never be stored is answered with the reason", "[metrics]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  FakeWorker worker = run.worker("w0");
  pump_until({&worker}, [&] {
    if (worker.records_matched()) worker.send({0, 0, "min-height"}, "rubbish", run.experiment.id);
    return !worker.refusals().empty();
  });
  CHECK_THAT(worker.refusals().front(), Contains("agent 'min-height'") && Contains("trace"));
  metrics->send(SIGINT);
  CHECK(metrics->wait().exit_code == 130);
}

TEST_CASE("two different results of one flight stop the run with an error", "[coordinator][metrics]") {
  const CoordinatedRun run;
  const auto metrics = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  FakeWorker worker = run.worker("w0");
  pump_until_confirmed(worker, 6);
  const experiment::FlightKey key{0, 0, "min-height"};
  worker.send(key, synthetic_trace(run.experiment, {0, 1, "min-height"}), run.experiment.id);
  pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
  const Finished collected = metrics->wait();
  CHECK(collected.exit_code == 1);
  CHECK_THAT(collected.err, Contains("flown twice with different results"));
  const Finished coordinated = coordinator->wait();
  CHECK(coordinated.exit_code == 1);
  CHECK_THAT(coordinated.err, Contains("aloft-metrics failed") && Contains("flown twice"));
}

TEST_CASE("interrupted and resumed", "[coordinator][metrics]") {
  const CoordinatedRun run;
  FakeWorker worker = run.worker("w0");
  {
    const auto metrics = run.start("aloft-metrics");
    const auto coordinator = run.start("aloft-coordinator");
    pump_until_confirmed(worker, 20);
    coordinator->send(SIGINT);
    pump_until(
        {&worker}, [&] { return !coordinator->running() && !metrics->running(); }, 10s);
    CHECK(coordinator->wait().exit_code == 130);
    CHECK(metrics->wait().exit_code == 0);  // it received the end of the run
    CHECK(worker.run_state() == wire::RUN_STOPPING);
  }
  worker.behaviour.flights_per_pump = 1;
  const auto metrics = run.start("aloft-metrics");
  const auto coordinator = run.start("aloft-coordinator");
  pump_until({&worker}, [&] { return !coordinator->running() && !metrics->running(); });
  CHECK(coordinator->wait().exit_code == 0);
  CHECK(times_flown(worker) == flights_total);
  run.check_results();
}

TEST_CASE("a run without workers reports it, and gives up after --give-up-after", "[coordinator]") {
  const CoordinatedRun run;
  const auto coordinator = run.start("aloft-coordinator", {"--give-up-after", "4.6"});
  const Finished finished = coordinator->wait(30s);
  CHECK(finished.exit_code == 1);
  CHECK_THAT(finished.err, Contains("no worker for 4 s; waiting for one to join") && Contains("--give-up-after"));
}

TEST_CASE("wrong input is refused with exit code 2", "[coordinator][metrics]") {
  const CoordinatedRun run;
  for (const char* program : {"aloft-coordinator", "aloft-metrics"}) {
    const Finished finished =
        run_command({program, "--results", run.results().string(), "--experiment", "/nonexistent.json"}, 30s);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("/nonexistent.json"));
    CHECK_FALSE(std::filesystem::exists(run.results()));
    const Finished unknown = run.start(program, {"--no-such-option"})->wait(30s);
    CHECK(unknown.exit_code == 2);
  }
  experiment::Experiment other = experiment::parse(coordination_text, "test", {{}, {}, 5, {}});
  (void)store::ResultStore::open_for_writing(run.results(), other);
  for (const char* program : {"aloft-coordinator", "aloft-metrics"}) {
    const Finished finished = run.start(program)->wait(30s);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("another"));
  }
}
