#include "services/coordinator/messages.hpp"

namespace aloft::coordinator {

wire::TrialAssignment to_wire(const Order& order, const std::string& experiment_id) {
  wire::TrialAssignment assignment;
  assignment.worker(wire::name(order.worker));
  assignment.experiment_id(wire::experiment_id(experiment_id));
  assignment.lease_id(order.lease);
  assignment.condition(order.condition);
  assignment.trial(order.trial);
  assignment.attempt(order.attempt);
  assignment.agents(wire::names(order.agents));
  assignment.cancelled(order.cancelled);
  return assignment;
}

wire::RunStatus to_wire(const Progress& progress, const std::string& experiment_id) {
  wire::RunStatus status;
  status.experiment_id(wire::experiment_id(experiment_id));
  status.flights_total(progress.flights_total);
  status.flights_stored(progress.flights_stored);
  status.trials_pending(progress.trials_pending);
  status.trials_leased(progress.trials_leased);
  status.trials_done(progress.trials_done);
  status.trials_failed(progress.trials_failed);
  status.workers_alive(progress.workers_alive);
  status.flights_per_s(progress.flights_per_s);
  status.steps_per_s(progress.steps_per_s);
  return status;
}

WorkerNews news_of(const wire::WorkerStatus& status) {
  WorkerNews news;
  news.report = {wire::view(status.worker()), status.incarnation(), status.capacity(), status.leases(), {}};
  news.host = wire::view(status.host());
  news.pid = status.pid();
  news.flies_only = wire::texts(status.flies_only());
  news.steps_done = status.steps_done();
  news.records_unconfirmed = status.records_unconfirmed();
  news.waits_for = wire::view(status.missing());
  for (const auto& failure : status.failures())
    news.failed_leases.emplace_back(failure.lease_id(), wire::view(failure.reason()));
  return news;
}

}  // namespace aloft::coordinator
