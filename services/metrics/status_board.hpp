#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "services/metrics/http_server.hpp"

namespace aloft::metrics {

/// The last news of the run, for HTTP. Thread-safe: the collector writes, the server reads.
class StatusBoard {
 public:
  using Clock = std::chrono::steady_clock;

  StatusBoard(const experiment::Experiment& experiment, std::string run);

  void on_run(const wire::RunStatus& status);
  void on_worker(const wire::WorkerStatus& status);
  /// From the collector's loop; `paused` says why nothing can be stored, or is empty.
  void on_tick(Clock::time_point now, const std::string& paused);

  /// {"run", "experiment", "experiment_id", "state", "flights_total", "flights_stored", "trials": {...}, rates,
  /// "message", "store", "workers": [...]}
  [[nodiscard]] std::string status_json() const;
  /// 503 if the collector's loop has stood still for 10 s.
  [[nodiscard]] HttpResponse health(Clock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  std::string run_name_;
  std::string experiment_name_;
  std::string experiment_id_;
  wire::RunStatus run_;
  std::map<std::string, wire::WorkerStatus> workers_;
  std::map<std::string, Clock::time_point> heard_;
  std::string paused_;
  Clock::time_point ticked_ = Clock::now();
};

}  // namespace aloft::metrics
