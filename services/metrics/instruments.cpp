#include "services/metrics/instruments.hpp"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <array>
#include <map>
#include <mutex>
#include <sstream>
#include <vector>

namespace aloft::metrics {
namespace {

/// Labels, in the order of Rejection.
constexpr std::array rejection_labels{"other_experiment", "unknown_flight", "bad_trace"};

prometheus::Counter& counter(prometheus::Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Gauge& gauge(prometheus::Registry& registry, const std::string& name, const std::string& help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

}  // namespace

struct Instruments::State {
  prometheus::Registry registry;
  prometheus::Counter& flights = counter(registry, "aloft_flights_stored_total", "Flights committed by this process");
  prometheus::Counter& steps = counter(registry, "aloft_steps_stored_total", "Steps of those flights");
  prometheus::Counter& duplicates =
      counter(registry, "aloft_records_duplicate_total", "Records of flights that were stored before");
  prometheus::Histogram& commit_seconds =
      prometheus::BuildHistogram()
          .Name("aloft_store_commit_seconds")
          .Help("Time of one durable commit")
          .Register(registry)
          .Add({}, prometheus::Histogram::BucketBoundaries{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0});
  prometheus::Gauge& paused = gauge(registry, "aloft_store_paused", "1 while nothing can be stored, else 0");
  prometheus::Gauge& dropped = gauge(registry, "aloft_samples_dropped",
                                     "Samples the bus dropped: malformed, or of another version or experiment");
  prometheus::Gauge& flights_total = gauge(registry, "aloft_flights_total", "Flights of the experiment");
  prometheus::Gauge& workers = gauge(registry, "aloft_workers_alive", "Workers the coordinator knows");
  prometheus::Histogram& answer_seconds =
      prometheus::BuildHistogram()
          .Name("aloft_answer_seconds")
          .Help("Time from the report of a step to the command that answers it, as the workers measure it")
          .Register(registry)
          .Add({}, prometheus::Histogram::BucketBoundaries(bus::answer_bounds_s.begin(), bus::answer_bounds_s.end()));
  std::array<prometheus::Counter*, rejection_labels.size()> rejected{};
  std::array<prometheus::Gauge*, bus::refusal_names.size()> refused{};  // without one for Refusal::none

  /// What a worker had counted in its last status.
  struct Told {
    std::uint64_t incarnation = 0;
    bus::AnswerCounts counts{};
    double seconds = 0.0;
  };
  std::mutex told_mutex;
  std::map<std::string, Told, std::less<>> told;
};

Instruments::Instruments() : state_(std::make_unique<State>()) {
  auto& family = prometheus::BuildCounter()
                     .Name("aloft_records_rejected_total")
                     .Help("Records that were not stored because they are wrong")
                     .Register(state_->registry);
  for (std::size_t i = 0; i < rejection_labels.size(); ++i)
    state_->rejected[i] = &family.Add({{"reason", rejection_labels[i]}});
  auto& refused = prometheus::BuildGauge()
                      .Name("aloft_datagrams_refused")
                      .Help("Datagrams that the guard kept from the middleware")
                      .Register(state_->registry);
  for (std::size_t i = 1; i < bus::refusal_names.size(); ++i)
    state_->refused[i] = &refused.Add({{"reason", std::string(bus::refusal_names[i])}});
}

Instruments::~Instruments() = default;

void Instruments::stored(std::size_t steps) {
  state_->flights.Increment();
  state_->steps.Increment(static_cast<double>(steps));
}
void Instruments::duplicate() {
  state_->duplicates.Increment();
}
void Instruments::rejected(Rejection reason) {
  state_->rejected[static_cast<std::size_t>(reason)]->Increment();
}
void Instruments::committed(double seconds) {
  state_->commit_seconds.Observe(seconds);
}
void Instruments::set_paused(bool paused) {
  state_->paused.Set(paused ? 1.0 : 0.0);
}
void Instruments::answered(std::string_view worker, std::uint64_t incarnation, const bus::AnswerCounts& counts,
                           double seconds) {
  const std::lock_guard lock(state_->told_mutex);
  State::Told& told = state_->told[std::string(worker)];
  if (told.incarnation != incarnation) told = {.incarnation = incarnation, .counts = {}, .seconds = 0.0};
  std::vector<double> increments;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] < told.counts[i]) return;  // an older status
    increments.push_back(static_cast<double>(counts[i] - told.counts[i]));
  }
  state_->answer_seconds.ObserveMultiple(increments, seconds - told.seconds);
  told.counts = counts;
  told.seconds = seconds;
}
void Instruments::set_samples_dropped(double total) {
  state_->dropped.Set(total);
}
void Instruments::set_datagrams_refused(const bus::RefusalCounts& counts) {
  for (std::size_t i = 1; i < counts.size(); ++i) state_->refused[i]->Set(static_cast<double>(counts[i]));
}
void Instruments::set_progress(double flights_total, double workers_alive) {
  state_->flights_total.Set(flights_total);
  state_->workers.Set(workers_alive);
}

std::string Instruments::prometheus_text() const {
  std::ostringstream text;
  prometheus::TextSerializer().Serialize(text, state_->registry.Collect());
  return text.str();
}

}  // namespace aloft::metrics
