#include "services/coordinator/coordinator_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <random>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/process_name.hpp"
#include "common/base/read_file.hpp"
#include "common/base/seconds.hpp"
#include "common/bus/convert.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "services/coordinator/folder_lock.hpp"
#include "services/coordinator/messages.hpp"
#include "services/coordinator/own_collector.hpp"
#include "services/coordinator/results_view.hpp"
#include "services/runtime/sole_coordinator.hpp"

namespace aloft::coordinator {
namespace {

using namespace std::chrono_literals;

constexpr auto tick_time = 50ms;
constexpr auto status_time = 500ms;
constexpr auto status_time_on_change = 100ms;
constexpr auto say_again_time = 10s;
constexpr auto offer_again_time = 2s;             // for a small experiment; a large one at this rate:
constexpr double offer_again_bytes_per_s = 50e3;  // to each process
constexpr auto farewell_time = 1s;                // for the last message to arrive
constexpr auto absence_time = 5s;                 // for absent processes to come back and receive it, too
constexpr auto absent_patience = 10s;             // a process that is silent for longer is not waited for
constexpr auto database_time = 10s;               // for the collector to make the database
constexpr auto reread_delay = 1s;                 // until both sides of a new connection know each other
constexpr auto rival_time = 500ms;                // between two answers to another coordinator
constexpr auto count_time = 10s;                  // for a collector on another host to report how much it has stored
constexpr std::uint32_t reread_flights = 5000;    // at a time: some 20 ms
constexpr std::size_t failures_told = 20;
constexpr std::size_t lost_named = 10;

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
        results_(options.results, experiment),
        coordinator_(experiment, options.coordinator, std::random_device{}(), Clock::now()),
        own_collector_(this_process().host, Clock::now()),
        worker_seen_(Clock::now()) {
    workers_.expect_experiment(experiment.id);
    stored_.expect_experiment(experiment.id);
    collector_.expect_experiment(experiment.id);
    waiter_.add(workers_);
    waiter_.add(stored_);
    waiter_.add(collector_);
    waiter_.add(sole_.reader());
    // Nothing is sent before: receivers would take it for the first coordinator's.
    is_sole_ = sole_.take(claim_, std::chrono::ceil<std::chrono::milliseconds>(options.look_around),
                          [this] { return stop_.requested(); });
    if (!is_sole_) return;
    // Only now, with the readers in place: what is stored while we read is reported over the bus.
    std::size_t resumed = 0;
    if (const store::ResultStore* database = results_.open(patience()))
      database->for_each_flight(
          [&](const store::FlightSummary& flight) { resumed += coordinator_.resume(flight.key) ? 1U : 0U; });
    spdlog::info("experiment {} ({}): {} flights, {} of them stored", experiment.name, experiment.id,
                 coordinator_.progress(Clock::now()).flights_total, resumed);
  }

  void run() {
    if (!is_sole_) return;
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
    if (!stopped && collector_failure_.empty()) compare_with_results();
    const bool succeeded = coordinator_.succeeded() && shortfall_.empty();
    finish(stopped ? wire::RUN_STOPPING : succeeded ? wire::RUN_FINISHED : wire::RUN_FAILED);
  }

 private:
  /// How long to wait for a database that is being made.
  [[nodiscard]] std::function<bool()> patience() {
    return [this, give_up = Clock::now() + database_time] {
      waiter_.wait(100ms);
      return !stop_.requested() && Clock::now() < give_up;
    };
  }

  void listen() {
    const auto now = Clock::now();
    if (const auto other = sole_.hear()) meet(*other, now);
    workers_.drain([&](const wire::WorkerStatus& status) { on_worker(status, now); });
    collector_.drain([&](const wire::CollectorStatus& status) { on_collector(status, now); });
    stored_.drain([&](const wire::EpisodeStored& stored) { on_stored(stored, now); });
    reread_database(now);
  }

  /// Another coordinator runs, and neither had received anything from the other when it started.
  void meet(const ProcessName& other, Clock::time_point now) {
    if (!runtime::SoleCoordinator::is_first(this_process(), other)) throw InputError(sole_.refusal(other));
    coordinator_.trouble(
        fmt::format("{} wants to coordinate this run, too; it has to end", to_text(other, "aloft-coordinator")), now);
    offer_at_ = std::min(offer_at_, now + rival_time);  // so that it notices us, and other processes follow us again
  }

  /// Any process can claim that a flight is stored. It counts if it is in the database or, where that is on another
  /// host, if the run's own collector confirms it.
  void on_stored(const wire::EpisodeStored& stored, Clock::time_point now) {
    const experiment::FlightKey flight{stored.condition(), stored.trial(), std::string(wire::view(stored.agent()))};
    if (!coordinator_.knows(flight)) return stored_.drop("the experiment has no such flight");
    if (!look_up(flight, stored.collector(), now)) return stored_.drop("this flight is not among the results");
    coordinator_.on_flight_stored(flight, now);
  }

  /// True if the flight is among the results. If they cannot be read, all of them are read again soon.
  [[nodiscard]] bool look_up(const experiment::FlightKey& flight, std::uint64_t collector, Clock::time_point now) {
    try {
      if (const store::ResultStore* database = results_.database()) return database->holds(flight);
    } catch (const std::exception& error) {
      spdlog::warn("cannot look up a flight, reads all of them again: {}", error.what());
      reread_at_ = now + reread_delay;
      return false;
    }
    return own_collector_.own() && own_collector_.own()->process.incarnation == collector;
  }

  void on_worker(const wire::WorkerStatus& status, Clock::time_point now) {
    coordinator_.on_worker(news_of(status), now);
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
    const store::ResultStore* database = results_.open(patience());
    if (database == nullptr) return reread_from_.reset();
    // In parts: workers must not seem silent meanwhile.
    reread_from_ = database->visit_part(*reread_from_, reread_flights, [&](const store::FlightSummary& flight) {
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
    wire::RunStatus status = to_wire(progress, experiment_.id);
    status.state(state);
    status.message(wire::message(message));
    statuses_.write(status);
  }

  void say(wire::RunState state) {
    wire::RunControl control;
    control.experiment_id(wire::experiment_id(experiment_.id));
    control.state(state);
    control.coordinator(bus::to_wire(this_process()));
    if (own_collector_.own()) control.collector(bus::to_wire(own_collector_.own()->process));
    control.refused(own_collector_.refused());
    control.experiment_json(wire::bytes(canonical_json_));
    controls_.write(control);
  }

  /// A process that starts late receives the last message, but in a run without keys a foreign process can send one,
  /// too, and push ours out of the reader's history. Processes cannot ask for the experiment, so it is repeated.
  void offer_again(Clock::time_point now) {
    if (now < offer_at_) return;
    say(wire::RUN_RUNNING);
    const std::chrono::duration<double> pause(static_cast<double>(canonical_json_.size()) / offer_again_bytes_per_s);
    offer_at_ = now + std::max<Clock::duration>(offer_again_time, std::chrono::ceil<Clock::duration>(pause));
  }

  void give_up_if_alone(Clock::time_point now) const {
    const double alone_s = seconds(now - worker_seen_);
    if (options_.give_up_after_s > 0.0 && alone_s > options_.give_up_after_s)
      throw std::runtime_error(fmt::format("gave up: no worker has reported for {:.0f} s (--give-up-after)", alone_s));
  }

  void on_collector(const wire::CollectorStatus& status, Clock::time_point now) {
    if (!meet_collector(status, now)) return;
    const std::string message(wire::view(status.message()));
    if (status.state() == wire::COLLECTOR_FAILED) collector_failure_ = "aloft-metrics failed: " + message;
    const bool paused = status.state() == wire::COLLECTOR_PAUSED;
    coordinator_.on_collector_paused(paused ? "aloft-metrics: " + message : "", now);
  }

  /// True if this is the run's own collector; every other one is refused.
  [[nodiscard]] bool meet_collector(const wire::CollectorStatus& status, Clock::time_point now) {
    const OwnCollector::News news{bus::from_wire(status.collector()), plain_text(wire::view(status.results())),
                                  status.flights_stored()};
    const bool known = own_collector_.is_own(news.process);
    const auto folder = known ? OwnCollector::Folder() : results_.look();
    if (!folder) return false;  // its next status will do
    using enum OwnCollector::Verdict;
    const OwnCollector::Verdict verdict = own_collector_.hear(news, *folder, now);
    if (verdict == now_own)
      spdlog::info("the flights are stored by {}, in '{}'", to_text(news.process, "aloft-metrics"), news.results);
    if (verdict == now_own && !folder->has_database)
      spdlog::warn("'{}' of host {} cannot be read here: what is stored there is only counted", news.results,
                   news.process.host);
    if (verdict == now_refused)
      coordinator_.trouble(fmt::format("refuses {}, which stores in '{}': this run stores in '{}'",
                                       to_text(news.process, "aloft-metrics"), news.results,
                                       std::filesystem::absolute(options_.results).string()),
                           now);
    if (verdict == now_own || verdict == now_refused) say(wire::RUN_RUNNING);
    return verdict == own || verdict == now_own;
  }

  /// Success is reported only after every flight has been found among the results.
  void compare_with_results() {
    try {
      if (const store::ResultStore* database = results_.open(patience()))
        find_lost(*database);
      else
        await_count();
    } catch (const std::exception& error) {
      shortfall_ = fmt::format("the results cannot be read: {}", error.what());
    }
  }

  void find_lost(const store::ResultStore& database) {
    std::vector<bool> is_there(coordinator_.progress(Clock::now()).flights_total);
    for (std::optional<std::int64_t> from = 0; from;) {
      notifier_.alive();
      from = database.visit_part(*from, reread_flights, [&](const store::FlightSummary& flight) {
        if (coordinator_.knows(flight.key)) is_there[coordinator_.number_of(flight.key)] = true;
      });
    }
    store::Shortfall lost;
    lost.first = coordinator_.lost_flights(is_there);
    lost.flights = lost.first.size();
    lost.first.resize(std::min(lost.first.size(), lost_named));
    if (lost.flights == 0) return;
    shortfall_ = fmt::format("flights were stored in '{}' and are not there any more: {}; the same command flies them",
                             options_.results.string(), lost.text(experiment_));
  }

  /// For a database that this host cannot read: its collector counts the flights.
  void await_count() {
    const auto stored = [this] { return own_collector_.own() ? own_collector_.own()->flights_stored : 0; };
    const std::uint64_t expected = coordinator_.progress(Clock::now()).flights_stored;
    const auto give_up = Clock::now() + count_time;
    while (stored() < expected && Clock::now() < give_up && !stop_.requested()) {
      waiter_.wait(tick_time);
      notifier_.alive();
      collector_.drain([this](const wire::CollectorStatus& status) { on_collector(status, Clock::now()); });
    }
    if (stored() < expected)
      shortfall_ = fmt::format("aloft-metrics has stored {} flights, and not {}; it names those that are missing",
                               stored(), expected);
  }

  /// Tells all processes how the run ended; throws if it failed.
  void finish(wire::RunState state) {
    say(state);
    std::vector<std::string> failures = coordinator_.failure_report();
    for (const std::string& trouble : {shortfall_, collector_failure_})
      if (!trouble.empty()) failures.insert(failures.begin(), trouble);
    failures.resize(std::min(failures.size(), failures_told));
    write_status(state, coordinator_.progress(Clock::now()), fmt::format("{}", fmt::join(failures, "\n")));
    wait_for_absent();
    const auto until = Clock::now() + farewell_time;
    if (!controls_.wait_acknowledged(farewell_time)) spdlog::warn("some processes have not confirmed the end");
    statuses_.wait_acknowledged(
        std::chrono::ceil<std::chrono::milliseconds>(std::max(until - Clock::now(), Clock::duration(1ms))));
    if (state != wire::RUN_FAILED) return;
    for (const std::string& failure : failures) spdlog::error("{}", failure);
    const Progress progress = coordinator_.progress(Clock::now());
    throw std::runtime_error(fmt::format("{} of {} flights stored, {} trials failed", progress.flights_stored,
                                         progress.flights_total, progress.trials_failed));
  }

  /// The end of a run is sent once, and reaches only processes that are connected: one that was lost a moment ago would
  /// wait for a coordinator that has ended.
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

  StopSignal& stop_;
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
  runtime::SoleCoordinator sole_{participant_};
  runtime::RunClaim claim_{participant_.options().run, participant_.options().domain, "coordinator"};
  bool is_sole_ = false;
  ResultsView results_;
  Coordinator coordinator_;
  OwnCollector own_collector_;
  std::string collector_failure_;
  std::string shortfall_;
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
  const FolderLock lock(options.results, this_process(), {}, [&service] { return service.stop.requested(); });
  Conversation(service, options, experiment).run();
}

}  // namespace aloft::coordinator
