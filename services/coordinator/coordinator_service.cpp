#include "services/coordinator/coordinator_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <random>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/store/result_store.hpp"

namespace aloft::coordinator {
namespace {

using namespace std::chrono_literals;

constexpr auto tick_time = 50ms;
constexpr auto status_time = 500ms;
constexpr auto status_time_on_change = 100ms;
constexpr auto say_again_time = 10s;
constexpr auto offer_again_time = 2s;             // the experiment, if it is small:
constexpr double offer_again_bytes_per_s = 50e3;  // to each process
constexpr auto farewell_time = 1s;                // for the last message to arrive
constexpr auto absence_time = 5s;                 // for the absent to come back and hear it, too
constexpr auto absent_patience = 10s;             // whoever is silent for longer is not waited for
constexpr auto database_time = 10s;               // for the collector to make the database
constexpr auto reread_delay = 1s;                 // until both sides of a new connection know each other
constexpr std::uint32_t reread_flights = 5000;    // at a time: some 20 ms
constexpr std::size_t failures_told = 20;

/// The collector's database, if there is one yet. The collector may be making it at this moment, so errors count only
/// when they stay.
void open_database(std::optional<store::ResultStore>& store, const std::filesystem::path& results,
                   const experiment::Experiment& experiment, bus::Waiter& waiter, const bus::StopSignal& stop) {
  const auto give_up = Clock::now() + database_time;
  while (!store && !stop.requested() && std::filesystem::exists(results / "results.sqlite")) {
    try {
      store.emplace(store::ResultStore::open_for_reading(results));
    } catch (const std::exception& error) {
      if (Clock::now() >= give_up) throw;
      spdlog::debug("the database is not ready: {}", error.what());
      waiter.wait(100ms);
    }
  }
  if (store && store->experiment().id != experiment.id)
    throw InputError(fmt::format(
        "--results {}: holds results of experiment {} ({}), not of {} ({}); choose another folder", results.string(),
        store->experiment().name, store->experiment().id, experiment.name, experiment.id));
}

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

/// A coordinator with a bus around it.
class Conversation {
 public:
  Conversation(runtime::Service& service, const ServiceOptions& options, const experiment::Experiment& experiment)
      : stop_(service.stop),
        notifier_(service.notifier),
        options_(options),
        experiment_(experiment),
        participant_(service.bus),
        waiter_(service.stop),
        coordinator_(experiment, options.coordinator, std::random_device{}(), Clock::now()),
        worker_seen_(Clock::now()) {
    workers_.expect_experiment(experiment.id);
    stored_.expect_experiment(experiment.id);
    collector_.expect_experiment(experiment.id);
    waiter_.add(workers_);
    waiter_.add(stored_);
    waiter_.add(collector_);
    // Only now, with the readers in place: what is stored while we read comes over the bus.
    std::size_t resumed = 0;
    open_database(database_, options_.results, experiment_, waiter_, stop_);
    if (database_)
      database_->for_each_flight(
          [&](const store::FlightSummary& flight) { resumed += coordinator_.resume(flight.key) ? 1U : 0U; });
    spdlog::info("experiment {} ({}): {} flights, {} of them stored", experiment.name, experiment.id,
                 coordinator_.progress(Clock::now()).flights_total, resumed);
  }

  void run() {
    say(wire::RUN_RUNNING);
    notifier_.ready(fmt::format("hands out experiment {}", experiment_.name));
    while (!stop_.requested() && !coordinator_.over() && collector_failure_.empty()) {
      waiter_.wait(reread_from_ ? 0ms : tick_time);
      notifier_.alive();
      listen();
      const auto now = Clock::now();
      for (const Order& order : coordinator_.tick(now)) assignments_.write(to_wire(order, experiment_.id));
      publish_status(now);
      offer_again(now);
      give_up_if_alone(now);
    }
    const bool stopped = !coordinator_.over() && collector_failure_.empty();
    finish(stopped ? wire::RUN_STOPPING : coordinator_.succeeded() ? wire::RUN_FINISHED : wire::RUN_FAILED);
  }

 private:
  void listen() {
    const auto now = Clock::now();
    workers_.drain([&](const wire::WorkerStatus& status) { on_worker(status, now); });
    stored_.drain([&](const wire::EpisodeStored& stored) {
      const bool ours = coordinator_.on_flight_stored(
          {stored.condition(), stored.trial(), std::string(wire::view(stored.agent()))}, now);
      if (!ours) spdlog::warn("the collector has stored a flight that the experiment does not have");
    });
    collector_.drain([&](const wire::CollectorStatus& status) { on_collector(status, now); });
    reread_database(now);
  }

  void on_worker(const wire::WorkerStatus& status, Clock::time_point now) {
    WorkerNews news;
    news.report = {wire::view(status.worker()), status.incarnation(), status.capacity(), status.leases(), {}};
    news.flies_only = wire::texts(status.flies_only());
    news.steps_done = status.steps_done();
    news.records_unconfirmed = status.records_unconfirmed();
    news.waits_for = wire::view(status.missing());
    for (const auto& failure : status.failures())
      news.failed_leases.emplace_back(failure.lease_id(), wire::view(failure.reason()));
    coordinator_.on_worker(news, now);
    worker_seen_ = now;
  }

  /// A collector that has just connected may have stored flights before it knew us.
  void reread_database(Clock::time_point now) {
    const std::size_t collectors = stored_.matched();
    if (collectors > collectors_) reread_at_ = now + reread_delay;
    collectors_ = collectors;
    if (now >= reread_at_) reread_from_ = 0;
    if (!reread_from_) return;
    reread_at_ = Clock::time_point::max();
    open_database(database_, options_.results, experiment_, waiter_, stop_);
    if (!database_) return reread_from_.reset();
    // In parts: workers must not seem silent meanwhile.
    reread_from_ = database_->visit_part(*reread_from_, reread_flights, [&](const store::FlightSummary& flight) {
      coordinator_.on_flight_stored(flight.key, now);
    });
  }

  void publish_status(Clock::time_point now) {
    if (now - told_at_ < status_time_on_change) return;
    const Progress progress = coordinator_.progress(now);
    const bool changed = progress.flights_stored != told_.flights_stored || progress.message != told_.message ||
                         progress.workers_alive != told_.workers_alive;
    if (!changed && now - told_at_ < status_time) return;
    told_at_ = now;
    if (!progress.message.empty() && (told_.message.empty() || now - said_at_ >= say_again_time)) {
      spdlog::warn("{}", progress.message);
      said_at_ = now;
    }
    if (now - progress_logged_at_ >= say_again_time) {
      progress_logged_at_ = now;
      spdlog::info("{} of {} flights stored, {:.1f} flights/s, {} workers", progress.flights_stored,
                   progress.flights_total, progress.flights_per_s, progress.workers_alive);
    }
    told_ = progress;
    write_status(wire::RUN_RUNNING, progress, progress.message);
  }

  void write_status(wire::RunState state, const Progress& progress, std::string_view message) {
    wire::RunStatus status;
    status.experiment_id(wire::experiment_id(experiment_.id));
    status.state(state);
    status.flights_total(progress.flights_total);
    status.flights_stored(progress.flights_stored);
    status.trials_pending(progress.trials_pending);
    status.trials_leased(progress.trials_leased);
    status.trials_done(progress.trials_done);
    status.trials_failed(progress.trials_failed);
    status.workers_alive(progress.workers_alive);
    status.flights_per_s(progress.flights_per_s);
    status.steps_per_s(progress.steps_per_s);
    status.message(wire::message(message));
    statuses_.write(status);
  }

  void say(wire::RunState state) {
    wire::RunControl control;
    control.experiment_id(wire::experiment_id(experiment_.id));
    control.state(state);
    control.experiment_json(wire::bytes(canonical_json_));
    controls_.write(control);
  }

  /// Who starts late gets what was said last, but in a run without keys a stranger may say something, too, and push it
  /// out of the newcomer's memory. Whoever does not know the experiment cannot say so: it is offered again and again.
  void offer_again(Clock::time_point now) {
    if (now < offer_at_) return;
    say(wire::RUN_RUNNING);
    const std::chrono::duration<double> pause(static_cast<double>(canonical_json_.size()) / offer_again_bytes_per_s);
    offer_at_ = now + std::max<Clock::duration>(offer_again_time, std::chrono::ceil<Clock::duration>(pause));
  }

  void give_up_if_alone(Clock::time_point now) const {
    const double alone_s = std::chrono::duration<double>(now - worker_seen_).count();
    if (options_.give_up_after_s > 0.0 && alone_s > options_.give_up_after_s)
      throw std::runtime_error(fmt::format("gave up: no worker has reported for {:.0f} s (--give-up-after)", alone_s));
  }

  void on_collector(const wire::CollectorStatus& status, Clock::time_point now) {
    const std::string message(wire::view(status.message()));
    if (status.state() == wire::COLLECTOR_FAILED) collector_failure_ = "aloft-metrics failed: " + message;
    if (status.state() == wire::COLLECTOR_PAUSED) coordinator_.on_collector_paused("aloft-metrics: " + message, now);
  }

  /// Tells everyone how it ended; throws if that was not well.
  void finish(wire::RunState state) {
    say(state);
    std::vector<std::string> failures = coordinator_.failure_report();
    if (!collector_failure_.empty()) failures.insert(failures.begin(), collector_failure_);
    failures.resize(std::min(failures.size(), failures_told));
    write_status(state, coordinator_.progress(Clock::now()), fmt::format("{}", fmt::join(failures, "\n")));
    wait_for_absent();
    const auto until = Clock::now() + farewell_time;
    if (!controls_.wait_acknowledged(farewell_time)) spdlog::warn("not everyone has heard that the run is over");
    statuses_.wait_acknowledged(
        std::chrono::ceil<std::chrono::milliseconds>(std::max(until - Clock::now(), Clock::duration(1ms))));
    if (state != wire::RUN_FAILED) return;
    for (const std::string& failure : failures) spdlog::error("{}", failure);
    const Progress progress = coordinator_.progress(Clock::now());
    throw std::runtime_error(fmt::format("{} of {} flights stored, {} trials failed", progress.flights_stored,
                                         progress.flights_total, progress.trials_failed));
  }

  /// Of the end of a run its last words tell, and they reach only those whom we know: who was lost a moment ago would
  /// wait for a coordinator that is no more.
  void wait_for_absent() {
    const auto until = Clock::now() + absence_time;
    for (bool told = false; !stop_.requested() && Clock::now() < until; std::this_thread::sleep_for(tick_time)) {
      const std::vector<std::string> absent = participant_.absent(absent_patience);
      if (absent.empty()) return;
      if (!told) spdlog::info("waits until these are back and hear that the run is over: {}", fmt::join(absent, ", "));
      told = true;
      notifier_.alive();
    }
  }

  bus::StopSignal& stop_;
  runtime::Notifier& notifier_;
  const ServiceOptions& options_;
  const experiment::Experiment& experiment_;
  const std::string canonical_json_ = experiment_.canonical.dump();
  bus::Participant participant_;
  bus::Waiter waiter_;
  bus::Writer<wire::RunControl> controls_{participant_};
  bus::Writer<wire::TrialAssignment> assignments_{participant_};
  bus::Writer<wire::RunStatus> statuses_{participant_};
  bus::Reader<wire::WorkerStatus> workers_{participant_};
  bus::Reader<wire::EpisodeStored> stored_{participant_};
  bus::Reader<wire::CollectorStatus> collector_{participant_};
  Coordinator coordinator_;
  std::optional<store::ResultStore> database_;
  std::string collector_failure_;
  Clock::time_point worker_seen_;
  std::size_t collectors_ = 0;
  Clock::time_point reread_at_ = Clock::time_point::max();
  std::optional<std::int64_t> reread_from_;  // while the database is reread
  Progress told_;
  Clock::time_point told_at_;
  Clock::time_point said_at_;
  Clock::time_point offer_at_ = Clock::now() + offer_again_time;
  Clock::time_point progress_logged_at_ = Clock::now();
};

}  // namespace

void coordinate(runtime::Service& service, const ServiceOptions& options) {
  const experiment::Experiment experiment =
      experiment::parse(read_file(options.experiment), options.experiment.string());
  Conversation(service, options, experiment).run();
}

}  // namespace aloft::coordinator
