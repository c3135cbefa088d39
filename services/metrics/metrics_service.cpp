#include "services/metrics/metrics_service.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/process_name.hpp"
#include "common/base/read_file.hpp"
#include "common/bus/convert.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "services/http/http_server.hpp"
#include "services/metrics/collector.hpp"
#include "services/metrics/status_board.hpp"

namespace aloft::metrics {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_time = 500ms;
constexpr auto say_again_time = 10s;
constexpr auto news_time = 1s;
constexpr auto farewell_time = 1s;

Record to_record(const wire::EpisodeRecord& sample) {
  Record record;
  record.experiment_id = wire::view(sample.experiment_id());
  record.episode_id = sample.episode_id();
  record.key = {sample.condition(), sample.trial(), std::string(wire::view(sample.agent()))};
  record.worker = wire::view(sample.worker());
  record.trace = wire::view(sample.trace());
  record.memory = wire::view(sample.agent_memory());
  return record;
}

/// A collector with a bus around it.
class Conversation {
 public:
  Conversation(runtime::Service& service, const ServiceOptions& options, const experiment::Experiment& experiment,
               store::ResultStore& store)
      : stop_(service.stop),
        notifier_(service.notifier),
        options_(options),
        experiment_(experiment),
        store_(store),
        board_(service.bus.run),
        collector_(experiment, commit_to(store_), instruments_),
        participant_(service.bus),
        waiter_(service.stop),
        flights_stored_(store_.count()) {
    records_.expect_experiment(experiment.id);
    memory_requests_.expect_experiment(experiment.id);
    controls_.expect_experiment(experiment.id);
    workers_.expect_experiment(experiment.id);
    runs_.expect_experiment(experiment.id);
    waiter_.add(records_);
    waiter_.add(memory_requests_);
    waiter_.add(controls_);
    if (options.http_port) serve_http();
  }

  void run() {
    notifier_.ready(fmt::format("stores experiment {}", experiment_.name));
    while (!stop_.requested() && !over_) {
      waiter_.wait(time_to_wait());
      notifier_.alive();
      sign();
      listen();
      store_due(false);
      publish();
    }
    listen();
    store_due(true);
    confirmations_.wait_acknowledged(farewell_time);
    if (!collector_.paused_because().empty())
      spdlog::warn("ends while {}; they will be sent again to the next aloft-metrics", collector_.paused_because());
  }

  /// Writes the summary of a run that is over. std::runtime_error if flights of the experiment are missing.
  void conclude() const {
    store::write_summary(options_.results);
    const store::Shortfall missing = store::shortfall(store_);
    if (missing.flights > 0)
      throw std::runtime_error(fmt::format("the run is over, and in '{}' {}; run it again: only these are flown",
                                           options_.results.string(), missing.text(experiment_)));
    spdlog::info("all {} flights are stored in '{}'", store_.count(), options_.results.string());
  }

 private:
  /// Writes into the database that this process writes it: the coordinator recognises its collector by that. On a full
  /// disk it is tried again later.
  void sign() {
    if (signed_ || Clock::now() < sign_at_) return;
    try {
      store_.sign(this_process());
      signed_ = true;
    } catch (const store::StoreFull& full) {
      warn_sometimes(full.what());
      sign_at_ = Clock::now() + news_time;
    }
  }

  void serve_http() {
    const auto health = [this](const http::HttpRequest&) { return board_.health(Clock::now()); };
    const auto status = [this](const http::HttpRequest&) {
      return http::HttpResponse{200, "application/json", board_.status_json()};
    };
    const auto numbers = [this](const http::HttpRequest&) {
      return http::HttpResponse{200, "text/plain; version=0.0.4; charset=utf-8", instruments_.prometheus_text()};
    };
    http_ = std::make_unique<http::HttpServer>(
        options_.http_address, *options_.http_port,
        std::map<std::string, http::HttpRoute>{
            {"/healthz", {health, true}}, {"/status", {status}}, {"/metrics", {numbers}}},
        options_.http_hosts);
    spdlog::info("http://{}:{}/status, /metrics and /healthz are up", options_.http_address, http_->port());
  }

  [[nodiscard]] std::chrono::milliseconds time_to_wait() const {
    const auto due = collector_.next_due();
    if (!due || !accepted_) return idle_time;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*due - Clock::now());
    return std::clamp(left, std::chrono::milliseconds(0), std::chrono::milliseconds(idle_time));
  }

  void listen() {
    records_.drain([this](const wire::EpisodeRecord& sample) {
      if (const auto refused = collector_.offer(to_record(sample), Clock::now())) refuse(sample, *refused);
      // The first record of a burst must not wait for the last one.
      if (const auto due = collector_.next_due(); due && *due <= Clock::now()) store_due(false);
    });
    memory_requests_.drain([this](const wire::MemoryRequest& request) { tell_memory(request); });
    workers_.drain([this](const wire::WorkerStatus& status) {
      board_.hear(status);
      instruments_.answered(wire::view(status.worker()), status.incarnation(), status.answer_counts(),
                            status.answer_s());
    });
    runs_.drain([this](const wire::RunStatus& status) {
      board_.hear(status);
      instruments_.set_progress(static_cast<double>(status.flights_total()), status.workers_alive());
    });
    controls_.drain([this](const wire::RunControl& control) { follow(control); });
  }

  void follow(const wire::RunControl& control) {
    board_.hear(control);
    const std::uint64_t self = this_process().incarnation;
    const ProcessName own = bus::from_wire(control.collector());
    const bool refused = std::ranges::find(control.refused(), self) != control.refused().end();
    const bool over = control.state() != wire::RUN_RUNNING;
    if (refused || (over && own.known() && own.incarnation != self)) throw InputError(refusal(own));
    if (own.known()) accepted_ = own.incarnation == self;
    const bool goes_on_later = options_.summary && control.state() == wire::RUN_STOPPING;
    over_ = over_ || (over && !goes_on_later);
  }

  /// Why the coordinator refuses this process; `own` is the run's own collector.
  [[nodiscard]] std::string refusal(const ProcessName& own) const {
    const std::string first =
        own.known() ? "is " + to_text(own, "aloft-metrics") : "writes the folder of its coordinator's --out";
    return fmt::format(
        "run '{}' has one collector, and it {}; this one, for the folder '{}', is refused: use another --run, or the "
        "folder of the run",
        participant_.options().run, first, options_.results.string());
  }

  /// Only the run's own collector stores: flights that another one confirms would be missing in the run's results.
  void store_due(bool flush) {
    try {
      store_.check_in_place();  // also when there is nothing to store
      if (!accepted_) return;
      for (const Acknowledgement& done : collector_.commit_due(Clock::now(), flush)) confirm(done);
    } catch (const std::runtime_error& error) {
      tell_failure(error);
      throw;
    }
  }

  /// Only the latest memory of a lineage is kept, but a worker that does not know yet that its lease is over can ask
  /// for an older one.
  void tell_memory(const wire::MemoryRequest& request) {
    if (!accepted_) return;  // the request is repeated
    const experiment::FlightKey key{request.condition(), request.trial(), request.agent().to_string()};
    try {
      const auto memory = store_.memory(key);
      if (!memory)
        return warn_sometimes(
            fmt::format("asked for the memory of agent '{}' after trial {}, which is not kept", key.agent, key.trial));
      wire::StoredMemory answer;
      answer.experiment_id(request.experiment_id());
      answer.condition(key.condition);
      answer.trial(key.trial);
      answer.agent(request.agent());
      answer.memory(wire::bytes(*memory));
      memories_.write(answer);
    } catch (const InputError& error) {
      warn_sometimes(error.what());
    } catch (const IntegrityError& error) {
      tell_failure(error);
      throw;
    }
  }

  void tell_failure(const std::runtime_error& error) {
    tell_collector(wire::COLLECTOR_FAILED, error.what());
    collector_news_.wait_acknowledged(farewell_time);
  }

  void confirm(const Acknowledgement& done) {
    if (!std::exchange(has_stored_, true)) spdlog::info("has stored its first flight, of agent {}", done.key.agent);
    if (done.is_new) ++flights_stored_;
    wire::EpisodeStored stored;
    stored.experiment_id(wire::experiment_id(experiment_.id));
    stored.episode_id(done.episode_id);
    stored.condition(done.key.condition);
    stored.trial(done.key.trial);
    stored.agent(wire::name(done.key.agent));
    stored.digest(wire::name(done.digest));
    stored.collector(this_process().incarnation);
    confirmations_.write(stored);
  }

  /// Tells the channel, which would send the record without end.
  void refuse(const wire::EpisodeRecord& sample, const std::string& reason) {
    warn_sometimes(reason);
    wire::RecordRefused refused;
    refused.experiment_id(sample.experiment_id());
    refused.episode_id(sample.episode_id());
    refused.digest(wire::name(sha256_hex(wire::view(sample.trace()))));
    refused.collector(this_process().incarnation);
    refused.reason(wire::message(reason));
    refusals_.write(refused);
  }

  /// Reports the collector's state to the coordinator and over HTTP.
  void publish() {
    const auto now = Clock::now();
    const std::string& paused = collector_.paused_because();
    board_.on_tick(now, paused);
    instruments_.set_samples_dropped(static_cast<double>(participant_.drops()));
    instruments_.set_datagrams_refused(participant_.refused());
    const bool changed = paused.empty() == was_paused_;
    if (changed && paused.empty()) spdlog::warn("stores again");
    if (!paused.empty() && (changed || now - said_at_ >= say_again_time)) {
      spdlog::warn("{}; free some space, trying again every second", paused);
      said_at_ = now;
    }
    was_paused_ = !paused.empty();
    if (!changed && now - told_at_ < news_time) return;
    told_at_ = now;
    tell_collector(paused.empty() ? wire::COLLECTOR_STORING : wire::COLLECTOR_PAUSED, paused);
  }

  void tell_collector(wire::CollectorState state, std::string_view message) {
    if (!signed_) return;  // the coordinator could not recognise its collector
    wire::CollectorStatus status;
    status.experiment_id(wire::experiment_id(experiment_.id));
    status.collector(bus::to_wire(this_process()));
    status.results(wire::message(std::filesystem::absolute(options_.results).string()));
    status.flights_stored(flights_stored_);
    status.state(state);
    status.message(wire::message(message));
    collector_news_.write(status);
    board_.hear(status);
    board_.on_middleware(participant_.middleware_of(participant_.options().run));
  }

  /// For faults of other processes, which can come often: logs one of them every say_again_time.
  void warn_sometimes(const std::string& refused) {
    const auto now = Clock::now();
    if (now - refused_at_ < say_again_time) return;
    refused_at_ = now;
    spdlog::warn("{}", refused);
  }

  StopSignal& stop_;
  runtime::Notifier& notifier_;
  const ServiceOptions& options_;
  const experiment::Experiment& experiment_;
  store::ResultStore& store_;
  Instruments instruments_;
  StatusBoard board_;
  Collector collector_;
  bus::Participant participant_;
  bus::Waiter waiter_;
  bus::Writer<wire::EpisodeStored> confirmations_{participant_};
  bus::Writer<wire::RecordRefused> refusals_{participant_};
  bus::Writer<wire::CollectorStatus> collector_news_{participant_};
  bus::Writer<wire::StoredMemory> memories_{participant_};
  bus::Reader<wire::EpisodeRecord> records_{participant_};
  bus::Reader<wire::MemoryRequest> memory_requests_{participant_};
  bus::Reader<wire::RunControl> controls_{participant_};
  bus::Reader<wire::WorkerStatus> workers_{participant_};
  bus::Reader<wire::RunStatus> runs_{participant_};
  std::unique_ptr<http::HttpServer> http_;
  std::uint64_t flights_stored_;
  bool signed_ = false;
  Clock::time_point sign_at_;
  bool accepted_ = false;  // the latest coordinator says that this is the run's own collector
  bool over_ = false;
  bool has_stored_ = false;
  bool was_paused_ = false;
  Clock::time_point told_at_;
  Clock::time_point said_at_;
  Clock::time_point refused_at_;
};

}  // namespace

void collect(runtime::Service& service, const ServiceOptions& options) {
  const experiment::Experiment experiment =
      experiment::parse(read_file(options.experiment), options.experiment.string());
  store::MadeResults made;
  try {
    store::ResultStore store = store::ResultStore::open_for_writing(options.results, experiment);
    made = store.made();
    Conversation conversation(service, options, experiment, store);
    conversation.run();
    if (options.summary && !service.stop.requested()) conversation.conclude();
  } catch (const InputError&) {
    store::take_back(made);
    throw;
  }
}

}  // namespace aloft::metrics
