#include "services/environment/environment.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <list>
#include <optional>

#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "services/environment/world_maker.hpp"
#include "services/runtime/run_follower.hpp"

namespace aloft::environment {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds wait_limit{200};
constexpr std::chrono::seconds missing_after{3};
constexpr std::chrono::seconds resend_period{1};
constexpr int max_sends = 10;
constexpr std::size_t max_queue = 256;

struct Environment {
  /// A trial whose world the channel has not confirmed.
  struct Pending {
    wire::TrialAssignment assignment;
    Clock::time_point due;
    int sends = 0;
  };

  Environment(const bus::BusOptions& place, StopSignal& stop_signal)
      : stop(stop_signal), participant(place), waiter(stop_signal) {
    waiter.add(follower.reader());
    waiter.add(assignments);
    waiter.add(worker_statuses);
  }

  void run() {
    while (!stop.requested() && !follower.over()) {
      waiter.wait(wait_limit);
      if (follower.update()) begin(*follower.experiment());
      if (!maker) continue;
      assignments.drain([this](const wire::TrialAssignment& assignment) { on_assignment(assignment); });
      worker_statuses.drain([this](const wire::WorkerStatus& status) { on_status(status); });
      serve();
    }
  }

  void begin(const experiment::Experiment& experiment) {
    assignments.expect_experiment(experiment.id);
    worker_statuses.expect_experiment(experiment.id);
    maker.emplace(experiment);
  }

  void on_assignment(const wire::TrialAssignment& assignment) {
    if (assignment.worker() != participant.options().worker) return;
    forget(assignment.lease_id());
    if (queue.size() == max_queue) queue.pop_front();  // its lease will be taken back
    queue.push_back({assignment, Clock::now()});
  }

  /// The channel says which leases it has: their worlds have arrived.
  void on_status(const wire::WorkerStatus& status) {
    if (status.worker() != participant.options().worker) return;
    for (const std::uint64_t lease : status.leases()) forget(lease);
    for (const wire::LeaseFailure& failure : status.failures()) forget(failure.lease_id());
  }

  void forget(std::uint64_t lease) {
    queue.remove_if(
        [&](const Pending& one) { return one.assignment.lease_id() == lease && !one.assignment.cancelled(); });
  }

  /// Sends worlds until the channel has them: it may be restarting, and what a dead process got is lost.
  void serve() {
    if (queue.empty()) return;
    if (worlds.matched() == 0) return tell_missing();
    missing_since.reset();
    told_missing = false;
    const auto now = Clock::now();
    queue.remove_if([&](Pending& one) {
      if (one.due > now || stop.requested()) return false;
      worlds.write(maker->make(one.assignment));
      one.due = now + resend_period;
      return one.assignment.cancelled() || ++one.sends == max_sends;
    });
  }

  void tell_missing() {
    if (!missing_since) missing_since = Clock::now();
    if (told_missing || Clock::now() - *missing_since < missing_after) return;
    told_missing = true;
    spdlog::warn("waits for aloft-channel of worker {}; {} trials wait for it", participant.options().worker,
                 queue.size());
  }

  StopSignal& stop;
  bus::Participant participant;
  runtime::RunFollower follower{participant};
  bus::Reader<wire::TrialAssignment> assignments{participant};
  bus::Reader<wire::WorkerStatus> worker_statuses{participant};
  bus::Writer<wire::World> worlds{participant};
  bus::Waiter waiter;

  std::optional<WorldMaker> maker;
  std::list<Pending> queue;
  std::optional<Clock::time_point> missing_since;
  bool told_missing = false;
};

}  // namespace

void make_worlds(const bus::BusOptions& place, StopSignal& stop) {
  Environment(place, stop).run();
}

}  // namespace aloft::environment
