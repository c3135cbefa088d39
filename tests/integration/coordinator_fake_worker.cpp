#include "tests/integration/coordinator_fake_worker.hpp"

#include <unistd.h>

#include "common/base/digest.hpp"
#include "common/base/random.hpp"

namespace aloft::test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t steps_per_flight = 20;
constexpr auto send_again_after = 300ms;
constexpr auto report_period = 100ms;

bus::BusOptions place(const std::string& run, int domain, const std::string& name) {
  bus::BusOptions options;
  options.run = run;
  options.worker = name;
  options.process = "fake-worker";
  options.domain = domain;
  return options;
}

}  // namespace

std::string synthetic_trace(const experiment::Experiment& experiment, const experiment::FlightKey& key) {
  RandomStream random(experiment.seed + key.condition, key.trial, key.agent);
  flight::FlightRecord flight;
  flight.pilots = {key.agent};
  flight.height_start_m = 40.0;
  for (std::uint32_t step = 1; step <= steps_per_flight; ++step) {
    flight::StepRecord record;
    record.step = step;
    record.action = agents::Action::hold;
    record.x_m = 10.0 * step;
    record.height_m = random.uniform(40.0, 240.0);
    record.serving_sinr_db = random.uniform(-10.0, 30.0);
    record.qos = random.uniform(0.0, 20.0);
    record.reward = record.qos;
    flight.steps.push_back(record);
  }
  return store::encode_trace(flight);
}

std::vector<experiment::FlightKey> all_flights(const experiment::Experiment& experiment) {
  std::vector<experiment::FlightKey> flights;
  for (const auto& condition : experiment.conditions)
    for (std::uint32_t trial = 0; trial < experiment.trials; ++trial)
      for (const auto& agent : experiment.agents) flights.push_back({condition.index, trial, agent.name});
  return flights;
}

FakeWorker::FakeWorker(const experiment::Experiment& experiment, const std::string& run, int domain,
                       const std::string& name)
    : experiment_(experiment), name_(name), participant_(place(run, domain, name)) {}

void FakeWorker::pump() {
  if (behaviour.silent) return;
  listen();
  fly();
  send_again();
  report();
}

void FakeWorker::listen() {
  assignments_.drain([this](const wire::TrialAssignment& assignment) { take(assignment); });
  controls_.drain([this](const wire::RunControl& control) {
    run_state_ = control.state();
    collector_ = control.collector().incarnation();
  });
  stored_.drain([this](const wire::EpisodeStored& stored) {
    const experiment::FlightKey key{stored.condition(), stored.trial(), std::string(wire::view(stored.agent()))};
    if (stored.collector() != collector_ || stored.digest() != sha256_hex(synthetic_trace(experiment_, key))) return;
    ++confirmations_;
    outbox_.erase(key);
    for (auto& [id, lease] : leases_) lease.unconfirmed.erase(key);
  });
  std::erase_if(leases_,
                [](const auto& lease) { return lease.second.to_fly.empty() && lease.second.unconfirmed.empty(); });
  refused_.drain([this](const wire::RecordRefused& refused) { refusals_.emplace_back(wire::view(refused.reason())); });
  runs_.drain([this](const wire::RunStatus& status) { run_message_ = wire::view(status.message()); });
}

void FakeWorker::take(const wire::TrialAssignment& assignment) {
  if (wire::view(assignment.worker()) != name_) return;
  if (assignment.cancelled()) {
    leases_.erase(assignment.lease_id());
    return;
  }
  if (!seen_.insert(assignment.lease_id()).second) return;
  if (behaviour.failing.contains({assignment.condition(), assignment.trial()})) {
    wire::LeaseFailure failure;
    failure.lease_id(assignment.lease_id());
    failure.reason(wire::message("made to fail"));
    failures_.push_back(failure);
    return;
  }
  Lease& lease = leases_[assignment.lease_id()];
  for (const std::string& agent : wire::texts(assignment.agents()))
    lease.to_fly.push_back({assignment.condition(), assignment.trial(), agent});
}

void FakeWorker::fly() {
  int left = behaviour.flights_per_pump;
  for (auto& [id, lease] : leases_) {
    for (; left > 0 && !lease.to_fly.empty(); --left) {
      const experiment::FlightKey key = lease.to_fly.back();
      lease.to_fly.pop_back();
      lease.unconfirmed.insert(key);
      ++flown_[key];
      steps_ += steps_per_flight;
      outbox_[key] = {};  // the record is sent at the next pump()
    }
  }
}

void FakeWorker::send_again() {
  const auto now = Clock::now();
  for (auto& [key, sent_at] : outbox_) {
    if (now - sent_at < send_again_after) continue;
    send(key, synthetic_trace(experiment_, key), experiment_.id);
    if (behaviour.duplicates) send(key, synthetic_trace(experiment_, key), experiment_.id);
    sent_at = now;
  }
}

void FakeWorker::send(const experiment::FlightKey& key, const std::string& trace, const std::string& experiment_id) {
  wire::EpisodeRecord record;
  record.experiment_id(wire::experiment_id(experiment_id));
  record.episode_id(experiment::episode_id(experiment_, key));
  record.condition(key.condition);
  record.trial(key.trial);
  record.agent(wire::name(key.agent));
  record.worker(wire::name(name_));
  record.trace(wire::bytes(trace));
  records_.write(record);
}

void FakeWorker::report() {
  const auto now = Clock::now();
  if (now - reported_at_ < report_period) return;
  reported_at_ = now;
  wire::WorkerStatus status;
  status.worker(wire::name(name_));
  status.experiment_id(wire::experiment_id(experiment_.id));
  status.host(wire::name("test"));
  status.pid(static_cast<std::uint32_t>(getpid()));
  status.incarnation(behaviour.incarnation);
  status.heartbeat(++heartbeat_);
  status.capacity(behaviour.capacity);
  for (const auto& [id, lease] : leases_) status.leases().push_back(id);
  status.failures(failures_);
  status.flights_done(flown_.size());
  status.steps_done(steps_);
  status.records_unconfirmed(static_cast<std::uint32_t>(outbox_.size()));
  status_.write(status);
}

}  // namespace aloft::test
