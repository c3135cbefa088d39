#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "common/bus/answer_times.hpp"
#include "common/bus/guard/refusal.hpp"

namespace aloft::metrics {

/// Why a record is refused; the label of aloft_records_rejected_total.
enum class Rejection { other_experiment, unknown_flight, bad_trace };

/// The collector's Prometheus metrics. Thread-safe.
class Instruments {
 public:
  Instruments();
  ~Instruments();

  void stored(std::size_t steps);
  void duplicate();
  void rejected(Rejection reason);
  void committed(double seconds);
  void set_paused(bool paused);
  /// What a worker has counted since it started: see WorkerStatus. `incarnation` tells one start from another.
  void answered(std::string_view worker, std::uint64_t incarnation, const bus::AnswerCounts& counts, double seconds);
  /// Samples that the bus dropped so far: malformed, or of another version or experiment.
  void set_samples_dropped(double total);
  /// Datagrams that the bus refused so far.
  void set_datagrams_refused(const bus::RefusalCounts& counts);
  void set_progress(double flights_total, double workers_alive);

  /// Text exposition format 0.0.4.
  [[nodiscard]] std::string prometheus_text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::metrics
